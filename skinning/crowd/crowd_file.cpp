#include "skinning/crowd/crowd_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <set>

#include <nlohmann/json.hpp>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "skinning/crowd/crowd_layout.h"
#include "skinning/files/glb_builder.h"

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// glTF's own numbers.
constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
              kUnsignedInt = 5125, kFloat = 5126;
constexpr int kVertices = 34962, kIndices = 34963;

// One end for all small pieces: appends a view and an accessor over it.
struct Scene {
  Json accessors = Json::array(), views = Json::array();

  int add(int buffer, std::size_t offset, std::size_t count, std::size_t element, int stride,
          int target, int component, const char* type, bool normalized) {
    Json view{{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", count * element}};
    if (stride > 0) view["byteStride"] = stride;
    if (target > 0) view["target"] = target;
    views.push_back(std::move(view));
    Json accessor{{"bufferView", views.size() - 1},
                  {"componentType", component},
                  {"count", count},
                  {"type", type}};
    if (normalized) accessor["normalized"] = true;
    accessors.push_back(std::move(accessor));
    return int(accessors.size()) - 1;
  }
};

template <class T>
std::size_t append(std::string& bytes, const std::vector<T>& values) {
  const std::size_t start = bytes.size();
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return start;
}

struct SharedAccessors {
  int indices = 0, joints = 0, weights = 0;
};

// Triangles and influences of all layers: bytes of the first buffer and the accessors over them.
// The skin's influences are each person's own.
std::vector<SharedAccessors> share(const CrowdPrototype& prototype, Scene& scene,
                                   std::string& bytes) {
  std::vector<SharedAccessors> out;
  for (const CrowdPrototype::Layer& layer : prototype.layers) {
    SharedAccessors& own = out.emplace_back();
    const std::size_t n = layer.vertices, corners = layer.F.size();
    if (n <= 65535) {
      const std::size_t at =
          append(bytes, std::vector<std::uint16_t>(layer.F.data(), layer.F.data() + corners));
      own.indices = scene.add(0, at, corners, 2, 0, kIndices, kUnsignedShort, "SCALAR", false);
    } else {
      const std::size_t at =
          append(bytes, std::vector<std::uint32_t>(layer.F.data(), layer.F.data() + corners));
      own.indices = scene.add(0, at, corners, 4, 0, kIndices, kUnsignedInt, "SCALAR", false);
    }
    if (layer.influences.empty()) continue;
    const QuantizedWeights shares = quantize_weights(layer.influences);
    own.joints = scene.add(0, append(bytes, shares.joints), n, kJointBytes, 0, kVertices,
                           kUnsignedByte, "VEC4", false);
    own.weights = scene.add(0, append(bytes, shares.weights), n, kWeightBytes, 0, kVertices,
                            kUnsignedShort, "VEC4", true);
  }
  return out;
}

std::string read_person(const CrowdMember& member, std::size_t size) {
  std::error_code failed;
  if (fs::file_size(member.file, failed) != size || failed)
    throw InputError(fmt::format("{}: not a person of this crowd; {} bytes were expected",
                                 member.file.string(), size));
  std::string bytes(size, '\0');
  std::ifstream in(member.file, std::ios::binary);
  if (!in.read(bytes.data(), std::streamsize(size)))
    throw InputError(member.file.string() + ": could not be read");
  return bytes;
}

// Least and largest of a layer's positions, as they are stored.
void add_bounds(const std::string& bytes, std::size_t at, std::size_t vertices, Json& accessor) {
  std::array<int, 3> low, high;
  low.fill(std::numeric_limits<int>::max()), high.fill(std::numeric_limits<int>::lowest());
  for (std::size_t v = 0; v < vertices; ++v) {
    std::int16_t place[3];
    std::memcpy(place, bytes.data() + at + kPositionBytes * v, sizeof place);
    for (std::size_t axis = 0; axis < 3; ++axis)
      low[axis] = std::min(low[axis], int{place[axis]}),
      high[axis] = std::max(high[axis], int{place[axis]});
  }
  accessor["min"] = low;
  accessor["max"] = high;
}

// Where a person's joints are, from their inverse bind matrices: units from the body's middle.
std::vector<Vec3> joint_places(const std::string& bytes, std::size_t joints) {
  std::vector<Vec3> out;
  for (std::size_t j = 0; j < joints; ++j) {
    float translation[3];
    std::memcpy(translation, bytes.data() + kMatrixBytes * j + 12 * sizeof(float),
                sizeof translation);
    out.emplace_back(-Eigen::Map<const Eigen::Vector3f>(translation).cast<double>());
  }
  return out;
}

Json rounded(const Vec3& v) {  // to a thousandth of a millimetre, so that the text stays short
  Json out = Json::array();
  for (double x : v) out.push_back(std::round(x * 1e6) / 1e6);
  return out;
}

Json extras_of(const CrowdMember& member) {
  Json out = Json::object();
  for (const auto& [name, text] : member.notes) out[name] = text;
  for (const auto& [name, value] : member.figures) out[name] = value;
  return out;
}

// How far a person reaches from their own middle, over the ground, m.
double reach_of(double unit, const Json& positions) {
  double out = 0;
  for (const char* end : {"min", "max"})
    for (std::size_t axis : {0, 2})
      out = std::max(out, unit * std::abs(positions[end][axis].get<int>()) / 32767);
  return out;
}

struct Document {
  Scene scene;
  Json nodes = Json::array(), meshes = Json::array(), skins = Json::array(), roots = Json::array();
  std::vector<std::size_t> people;  // nodes
  double reach = 0;                 // the largest of all
};

void add_person(const CrowdPrototype& prototype, const CrowdLayout& layout,
                const std::vector<SharedAccessors>& shared, const CrowdMember& member, int buffer,
                std::size_t begin, Document& out) {
  const std::string bytes = read_person(member, layout.size);
  const std::size_t joints = prototype.skeleton.joints.size(), root = out.nodes.size(),
                    first = root + 2;
  float unit;
  std::memcpy(&unit, bytes.data() + layout.unit, sizeof unit);
  const std::vector<Vec3> places = joint_places(bytes, joints);
  out.nodes.push_back({{"name", member.name},
                       {"translation", nullptr},
                       {"children", Json::array({root + 1})},
                       {"extras", extras_of(member)}});
  out.nodes.push_back({{"name", member.name + "/middle"},
                       {"translation", rounded(kCrowdMiddle)},
                       {"children", Json::array({first})}});
  if (unit != 1) out.nodes.back()["scale"] = std::array<float, 3>{unit, unit, unit};
  out.roots.push_back(root);
  out.people.push_back(root);
  Json skin{{"inverseBindMatrices",
             out.scene.add(buffer, begin, joints, kMatrixBytes, 0, 0, kFloat, "MAT4", false)},
            {"skeleton", first},
            {"joints", Json::array()}};
  for (std::size_t j = 0; j < joints; ++j) {
    const Joint& joint = prototype.skeleton.joints[j];
    const Vec3 from = joint.parent < 0 ? Vec3(Vec3::Zero()) : places[joint.parent];
    out.nodes.push_back({{"name", joint.name}, {"translation", rounded(places[j] - from)}});
    if (joint.parent >= 0) out.nodes[first + joint.parent]["children"].push_back(first + j);
    skin["joints"].push_back(first + j);
  }
  out.skins.push_back(std::move(skin));
  for (std::size_t l = 0; l < layout.layers.size(); ++l) {
    const CrowdLayout::Layer& layer = layout.layers[l];
    const int positions =
        out.scene.add(buffer, begin + layer.positions, layer.vertices, kPositionBytes,
                      kPositionBytes, kVertices, kShort, "VEC3", true);
    Json& accessor = out.scene.accessors[positions];
    add_bounds(bytes, layer.positions, layer.vertices, accessor);
    out.reach = std::max(out.reach, reach_of(double(unit), accessor));
    const int normals = out.scene.add(buffer, begin + layer.normals, layer.vertices, kNormalBytes,
                                      kNormalBytes, kVertices, kByte, "VEC3", true);
    SharedAccessors by = shared[l];
    if (prototype.layers[l].influences.empty()) {
      by.joints = out.scene.add(buffer, begin + layout.joints, layer.vertices, kJointBytes, 0,
                                kVertices, kUnsignedByte, "VEC4", false);
      by.weights = out.scene.add(buffer, begin + layout.weights, layer.vertices, kWeightBytes, 0,
                                 kVertices, kUnsignedShort, "VEC4", true);
    }
    const std::string name = member.name + "/" + prototype.layers[l].name;
    out.meshes.push_back({{"name", name},
                          {"primitives", Json::array({{{"attributes",
                                                        {{"POSITION", positions},
                                                         {"NORMAL", normals},
                                                         {"JOINTS_0", by.joints},
                                                         {"WEIGHTS_0", by.weights}}},
                                                       {"indices", by.indices},
                                                       {"material", l}}})}});
    // Skinned meshes go with their joints and are roots themselves.
    out.roots.push_back(out.nodes.size());
    out.nodes.push_back(
        {{"name", name}, {"mesh", out.meshes.size() - 1}, {"skin", out.skins.size() - 1}});
  }
}

// In rows, so far apart that nobody's arms reach into a neighbour.
void place_people(Document& document) {
  constexpr double kGap = 0.1, kLeast = 1.5;  // m
  const double apart = std::max(kLeast, std::ceil(10 * (2 * document.reach + kGap)) / 10);
  const std::size_t in_a_row = std::ceil(std::sqrt(double(document.people.size())));
  for (std::size_t i = 0; i < document.people.size(); ++i)
    document.nodes[document.people[i]]["translation"] =
        rounded({apart * double(i % in_a_row), 0, -apart * double(i / in_a_row)});
}

Json material(const TissueLook& look) {
  return {{"name", look.name},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", gltf::base_color(look)},
            {"metallicFactor", 0.0},
            {"roughnessFactor", look.roughness}}}};
}

Json parts_of(const CrowdPrototype::Layer& layer) {
  Json out = Json::array();
  for (const CrowdPrototype::Part& part : layer.parts)
    out.push_back(Json::array({part.name, part.vertex_begin, part.vertex_end}));
  return out;
}

Json to_json(const CrowdPrototype& prototype, Document&& document, Json buffers) {
  Json out;
  out["asset"] = {{"version", "2.0"}, {"generator", fmt::format("ecorche {}", ECORCHE_VERSION)}};
  out["extensionsUsed"] = out["extensionsRequired"] = Json::array({"KHR_mesh_quantization"});
  out["scene"] = 0;
  Json crowd{{"schema", kCrowdSchema},
             {"people", document.people.size()},
             {"joint_frames", crowd_layout(prototype).frames}};
  for (const CrowdPrototype::Layer& layer : prototype.layers)
    if (!layer.parts.empty()) crowd[layer.name] = parts_of(layer);
  out["scenes"] = Json::array(
      {{{"name", "crowd"}, {"nodes", std::move(document.roots)}, {"extras", {{"crowd", crowd}}}}});
  out["nodes"] = std::move(document.nodes);
  out["meshes"] = std::move(document.meshes);
  out["skins"] = std::move(document.skins);
  out["materials"] = Json::array({material(kSkinLook)});
  if (prototype.layers.size() > 1) {
    out["materials"].push_back(material(kBoneLook));
    out["materials"].push_back(material(kMuscleLook));
  }
  out["accessors"] = std::move(document.scene.accessors);
  out["bufferViews"] = std::move(document.scene.views);
  out["buffers"] = std::move(buffers);
  return out;
}

void write_number(std::ostream& out, std::size_t value) {
  const std::uint32_t word = value;
  out.write(reinterpret_cast<const char*>(&word), sizeof word);
}

void write_glb(const fs::path& file, const CrowdLayout& layout,
               const std::vector<CrowdMember>& members, std::string text,
               const std::string& shared) {
  AtomicFile out(file);
  std::ostream& stream = out.stream();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t binary = shared.size() + members.size() * layout.size;
  stream.write("glTF", 4);
  write_number(stream, 2);
  write_number(stream, 12 + 8 + text.size() + 8 + binary);
  write_number(stream, text.size());
  stream.write("JSON", 4);
  stream << text;
  write_number(stream, binary);
  stream.write("BIN\0", 4);
  stream << shared;
  for (const CrowdMember& member : members) stream << read_person(member, layout.size);
  if (!stream) out.fail();
  out.commit();
}

}  // namespace

void write_crowd(const fs::path& file, const CrowdPrototype& prototype,
                 const std::vector<CrowdMember>& members) {
  const bool one_file = file.extension() == ".glb";
  if (!one_file && file.extension() != ".gltf")
    throw UsageError(file.string() + ": a crowd is written as .glb or .gltf");
  std::set<std::string> names;
  for (const CrowdMember& member : members)
    if (!names.insert(member.name).second)
      throw UsageError(fmt::format("{}: two people are named '{}'", file.string(), member.name));
  const CrowdLayout layout = crowd_layout(prototype);
  Document document;
  std::string shared;
  const std::vector<SharedAccessors> accessors = share(prototype, document.scene, shared);
  constexpr double kRoom = 4.2e9;  // of a .glb, whose length is a 32-bit number; text and all
  if (one_file && double(members.size()) * (double(layout.size) + 2e4) > kRoom)
    throw LimitError(fmt::format(
        "{}: {} people do not fit into the 4 GiB of a .glb; write a .gltf, or several files",
        file.string(), members.size()));

  const fs::path shared_file = fs::path(file).replace_extension(".shared");
  Json buffers = Json::array();
  if (!one_file)
    buffers.push_back({{"uri", shared_file.filename().string()}, {"byteLength", shared.size()}});
  for (std::size_t i = 0; i < members.size(); ++i) {
    add_person(prototype, layout, accessors, members[i], one_file ? 0 : int(i) + 1,
               one_file ? shared.size() + i * layout.size : 0, document);
    if (one_file) continue;
    if (!fs::equivalent(fs::absolute(members[i].file).parent_path(),
                        fs::absolute(file).parent_path()))
      throw UsageError(fmt::format("{}: a .gltf must lie in the folder of the people's files, {}",
                                   file.string(), members[i].file.parent_path().string()));
    buffers.push_back({{"uri", members[i].file.filename().string()}, {"byteLength", layout.size}});
  }
  place_people(document);
  if (one_file) buffers.push_back({{"byteLength", shared.size() + members.size() * layout.size}});
  std::string text = to_json(prototype, std::move(document), std::move(buffers)).dump();
  if (one_file) return write_glb(file, layout, members, std::move(text), shared);
  write_file_atomically(shared_file, shared);
  write_file_atomically(file, text);
}

}  // namespace ecorche::inline v1
