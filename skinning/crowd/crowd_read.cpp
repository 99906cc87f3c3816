#include "skinning/crowd/crowd_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/mesh_files/gltf_file.h"
#include "skinning/crowd/crowd_layout.h"
#include "skinning/crowd/crowd_text.h"
#include "skinning/files/character_check.h"

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kMark = "\"crowd\":{\"schema\"";  // as write_crowd has it

// The glTF text of a file and where the bytes behind it begin; empty for what is neither .glb nor
// .gltf.
struct Text {
  std::string words;
  std::uintmax_t binary = 0, binary_size = 0;
};

// Throws InputError for what is no file that can be read.
Text read_text(const fs::path& file) {
  check_input_file(file);
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  Text out;
  std::uint32_t header[5]{}, chunk[2]{};
  const bool binary = in.read(reinterpret_cast<char*>(header), sizeof header) &&
                      std::memcmp(header, "glTF", 4) == 0;
  if (!binary && file.extension() != ".gltf") return {};
  const std::uintmax_t length = binary ? header[3] : size, begin = binary ? sizeof header : 0;
  if (length > limits::kCrowdJsonBytes || begin + length > size) return {};
  in.clear();
  in.seekg(std::streamoff(begin));
  out.words.resize(length);
  if (!in.read(out.words.data(), std::streamsize(length))) return {};
  if (!binary || !in.read(reinterpret_cast<char*>(chunk), sizeof chunk)) return out;
  out.binary = begin + length + sizeof chunk;
  out.binary_size = std::min<std::uintmax_t>(chunk[0], size - out.binary);
  return out;
}

// The element that an object's member counts.
const Json& element(const CrowdText& text, const char* list, std::size_t index) {
  const Json& all = text.document.at(list);
  if (!all.is_array() || index >= all.size())
    fail(text, fmt::format("there is no {} {}", list, index));
  return all[index];
}

void find_buffers(const Text& text, CrowdText& out) {
  for (const Json& buffer : out.document.at("buffers")) {
    CrowdText::Buffer one{out.file, text.binary, text.binary_size};
    if (buffer.contains("uri")) {
      one = {file_beside(out.file.parent_path(), buffer.at("uri").get<std::string>(),
                         printable(out.file.string())),
             0, 0};
      check_input_file(one.file);
      one.size = fs::file_size(one.file);
    }
    const std::size_t stated = whole_number(out, buffer, "byteLength");
    if (stated == 0) fail(out, fmt::format("buffer {} is empty", out.buffers.size()));
    if (stated > one.size) fail(out, fmt::format("{} is shorter than it says", one.file.string()));
    one.size = stated;
    out.buffers.push_back(std::move(one));
  }
}

// What nobody reads here, other programs will: every view inside its buffer, every accessor's view
// there.
void check_views(const CrowdText& text) {
  const Json& views = text.document.at("bufferViews");
  for (std::size_t v = 0; v < views.size(); ++v) {
    const std::size_t buffer = whole_number(text, views[v], "buffer"),
                      offset = whole_number(text, views[v], "byteOffset", 0),
                      length = whole_number(text, views[v], "byteLength");
    const std::uintmax_t size = buffer < text.buffers.size() ? text.buffers[buffer].size : 0;
    if (offset > size || length > size - offset)
      fail(text,
           fmt::format("bufferView {} reaches beyond buffer {} of {} bytes", v, buffer, size));
  }
  const Json& accessors = text.document.at("accessors");
  for (std::size_t i = 0; i < accessors.size(); ++i)
    if (whole_number(text, accessors[i], "bufferView") >= views.size())
      fail(text, fmt::format("accessor {}: there is no bufferView {}", i,
                             accessors[i].at("bufferView").dump()));
}

void find_people(CrowdText& out) {
  const Json& nodes = out.document.at("nodes");
  out.parents.assign(nodes.size(), -1);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].contains("children"))
      for (const Json& child : nodes[n].at("children")) {
        const auto c = child.is_number_unsigned() ? child.get<std::size_t>() : nodes.size();
        if (c >= nodes.size() || out.parents[c] >= 0)
          fail(out, fmt::format("node {} has children that are none, or another's", n));
        out.parents[c] = int(n);
      }
    const std::string name = nodes[n].value("name", std::string());
    if (!nodes[n].contains("mesh") || !name.ends_with("/skin")) continue;
    if (!out.skins.emplace(name.substr(0, name.size() - 5), int(n)).second)
      fail(out, fmt::format("two people are named '{}'", name.substr(0, name.size() - 5)));
  }
}

std::string names_of(const std::vector<std::string>& people) {
  constexpr std::size_t kMost = 12;
  std::string out;
  for (std::size_t i = 0; i < std::min(kMost, people.size()); ++i)
    out += (i > 0 ? ", " : "") + people[i];
  return people.size() > kMost ? fmt::format("{} and {} more", out, people.size() - kMost) : out;
}

// Values of an accessor that is as write_crowd has them.
template <class T>
std::vector<T> values_of(const CrowdText& text, std::size_t accessor, int component,
                         const char* type, std::size_t stride, std::size_t* begin = nullptr) {
  const Json& one = element(text, "accessors", accessor);
  const Json& view = element(text, "bufferViews", whole_number(text, one, "bufferView"));
  const std::size_t count = whole_number(text, one, "count"),
                    offset = whole_number(text, view, "byteOffset", 0);
  if (one.value("componentType", 0) != component || one.value("type", std::string()) != type ||
      one.contains("byteOffset") || one.contains("sparse"))
    fail(text, fmt::format("accessor {} is of a kind that ecorche does not write", accessor));
  if (count > limits::kCrowdJsonBytes / stride)
    fail(text, fmt::format("accessor {} has {} elements", accessor, count));
  const std::string bytes =
      read_buffer(text, whole_number(text, view, "buffer"), offset, count * stride);
  if (begin) *begin = offset;
  std::vector<T> out(bytes.size() / sizeof(T));
  if (!out.empty()) std::memcpy(out.data(), bytes.data(), bytes.size());
  return out;
}

void read_figures(const CrowdText& text, const Json& node, Body& body) {
  const Json& extras = node.at("extras");
  const std::string sex = extras.value("sex", std::string("male"));
  if (sex != "male" && sex != "female") fail(text, fmt::format("{}: sex '{}'", body.name, sex));
  body.sex = sex == "male" ? Sex::male : Sex::female;
  body.age = extras.value("age", body.age);
  body.mass = extras.value("weight_kg", body.mass);
}

Mat3 matrix_of(const float* values) {
  return Eigen::Map<const Eigen::Matrix3f>(values).cast<double>();
}

// Joints from inverse bind matrices and from what follows them.
Skeleton read_skeleton(const CrowdText& text, const Json& skin, double& unit) {
  const Json& nodes = text.document.at("nodes");
  const Json& joints = skin.at("joints");
  std::size_t begin = 0;
  const auto binds = values_of<float>(text, whole_number(text, skin, "inverseBindMatrices"), 5126,
                                      "MAT4", kMatrixBytes, &begin);
  if (joints.empty() || joints.size() > limits::kCrowdJoints || binds.size() != 16 * joints.size())
    fail(text, "a skin's joints and matrices do not belong together");
  const Json& view =
      element(text, "bufferViews",
              whole_number(
                  text, element(text, "accessors", whole_number(text, skin, "inverseBindMatrices")),
                  "bufferView"));
  const std::size_t frames =
      whole_number(text, text.document.at("scenes").at(0).at("extras").at("crowd"), "joint_frames");
  const std::string bytes =
      read_buffer(text, whole_number(text, view, "buffer"), begin + frames - sizeof(float),
                  sizeof(float) * (1 + kFrameFloats * joints.size()));
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  if (!Eigen::Map<const Eigen::VectorXf>(values.data(), Eigen::Index(values.size())).allFinite() ||
      !(values[0] > 0 && values[0] < 100) ||
      !Eigen::Map<const Eigen::VectorXf>(binds.data(), Eigen::Index(binds.size())).allFinite())
    fail(text, "a joint is not finite");
  unit = double(values[0]);
  Skeleton out;
  std::map<int, int> known;
  std::vector<Vec3> places;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const std::size_t node =
        joints[j].is_number_unsigned() ? joints[j].get<std::size_t>() : nodes.size();
    if (node >= nodes.size()) fail(text, "a skin names a joint that is none");
    Joint joint;
    joint.name = nodes[node].value("name", std::string());
    const auto parent = known.find(text.parents[node]);
    joint.parent = parent == known.end() ? -1 : parent->second;
    if ((joint.parent < 0) != (j == 0))
      fail(text, fmt::format("joint '{}' does not follow its parent", joint.name));
    known[node] = int(j);
    const float* own = values.data() + 1 + kFrameFloats * j;
    const Mat3 angles = matrix_of(own + 9);
    joint.axes = matrix_of(own), joint.zero = angles.col(0), joint.min = angles.col(1),
    joint.max = angles.col(2);
    const Eigen::Matrix4f bind = Eigen::Map<const Eigen::Matrix4f>(binds.data() + 16 * j);
    if (!bind.leftCols<3>().isApprox(Eigen::Matrix<float, 4, 3>::Identity()) || bind(3, 3) != 1.0F)
      fail(text, fmt::format("joint '{}' has an inverse bind matrix that does more than move",
                             joint.name));
    places.push_back(
        kCrowdMiddle -
        unit * Eigen::Map<const Eigen::Vector3f>(binds.data() + 16 * j + 12).cast<double>());
    joint.X_PJ.translation() = j == 0 ? places[j] : Vec3(places[j] - places[joint.parent]);
    check_joint(
        joint, fmt::format("{}: joint '{}'", printable(text.file.string()), printable(joint.name)));
    out.joints.push_back(std::move(joint));
  }
  return out;
}

TriMesh read_skin(const CrowdText& text, const Json& node, double unit) {
  const Json& primitive =
      element(text, "meshes", whole_number(text, node, "mesh")).at("primitives").at(0);
  const auto places =
      values_of<std::int16_t>(text, whole_number(text, primitive.at("attributes"), "POSITION"),
                              5122, "VEC3", kPositionBytes);
  const std::size_t vertices = places.size() / 4,
                    indices = whole_number(text, primitive, "indices");
  TriMesh out;
  out.V.resize(vertices, 3);
  for (std::size_t v = 0; v < vertices; ++v)
    for (std::size_t k = 0; k < 3; ++k)
      out.V(v, Eigen::Index(k)) = kCrowdMiddle[k] + unit * places[4 * v + k] / 32767;
  std::vector<std::uint32_t> corners;
  if (vertices > 65535) {
    corners = values_of<std::uint32_t>(text, indices, 5125, "SCALAR", 4);
  } else {
    for (const std::uint16_t corner : values_of<std::uint16_t>(text, indices, 5123, "SCALAR", 2))
      corners.push_back(corner);
  }
  if (corners.size() % 3 != 0) fail(text, "a skin's indices are no triangles");
  out.F.resize(corners.size() / 3, 3);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] >= vertices)
      fail(text, fmt::format("triangle corner {} of {} vertices", corners[i], vertices));
    out.F(i / 3, Eigen::Index(i % 3)) = int(corners[i]);
  }
  return out;
}

}  // namespace

bool is_crowd(const fs::path& file) try {
  return read_text(file).words.find(kMark) != std::string::npos;
} catch (const InputError&) {  // whoever reads it says why
  return false;
}

std::optional<CrowdAddress> crowd_address(const fs::path& file) {
  if (is_crowd(file)) {
    const std::vector<std::string> people = open_crowd(file).people;
    throw InputError(fmt::format("{}: a crowd of {} people; name one of them, like {}#{} ({})",
                                 file.string(), people.size(), file.string(), people.at(0),
                                 names_of(people)));
  }
  const std::string whole = file.string();
  const auto mark = whole.rfind('#');
  std::error_code error;
  if (mark == std::string::npos || fs::exists(file, error) || !is_crowd(whole.substr(0, mark)))
    return std::nullopt;
  return CrowdAddress{whole.substr(0, mark), whole.substr(mark + 1)};
}

void refuse_crowd(const fs::path& file) {
  if (const std::optional<CrowdAddress> one = crowd_address(file))
    throw InputError(
        fmt::format("{}: a crowd has its people's muscles only as meshes; `ecorche fit '{}' -o "
                    "{}.glb` makes a character of this one",
                    file.string(), file.string(), one->person));
}

Crowd open_crowd(const fs::path& file) try {
  auto text = std::make_shared<CrowdText>();
  text->file = file;
  Text read = read_text(file);
  if (read.words.find(kMark) == std::string::npos)
    fail(*text, "not a crowd; `ecorche body population --crowd` writes one");
  text->document =
      parse_gltf_json<Json>(read.words, printable(file.string()), limits::kCrowdJsonBytes);
  std::string().swap(read.words);
  const std::size_t schema =
      whole_number(*text, text->document.at("scenes").at(0).at("extras").at("crowd"), "schema");
  if (schema > kCrowdSchema)
    throw UnfitError(fmt::format(
        "{}: a crowd written by a newer version (schema {}, this program reads {}); update ecorche",
        printable(file.string()), schema, kCrowdSchema));
  if (schema != kCrowdSchema)
    fail(*text, fmt::format("a crowd of an older version (schema {}, this program reads {}); make "
                            "it anew with `ecorche body population --crowd`",
                            schema, kCrowdSchema));
  find_buffers(read, *text);
  check_views(*text);
  find_people(*text);
  Crowd out;
  for (const auto& [name, node] : text->skins) out.people.push_back(name);
  std::sort(out.people.begin(), out.people.end(), [&](const std::string& a, const std::string& b) {
    return text->skins.at(a) < text->skins.at(b);
  });
  if (out.people.empty()) fail(*text, "nobody is in it");
  out.text = std::move(text);
  return out;
} catch (const nlohmann::json::exception& e) {
  throw InputError(
      fmt::format("{}: a damaged crowd: {}", printable(file.string()), printable(e.what())));
}

CrowdPerson read_crowd_person(const Crowd& crowd, const std::string& name) try {
  const CrowdText& text = *crowd.text;
  const auto found = text.skins.find(name);
  if (found == text.skins.end())
    fail(text, fmt::format("nobody is named '{}'; there are {}", name, names_of(crowd.people)));
  const Json& node = text.document.at("nodes")[found->second];
  const Json& skin = element(text, "skins", whole_number(text, node, "skin"));
  CrowdPerson out;
  double unit = 1;
  out.skeleton = read_skeleton(text, skin, unit);
  out.body.skin = read_skin(text, node, unit);
  out.body.name = name;
  const int middle = text.parents[skin.at("joints").at(0).get<std::size_t>()],
            root = middle < 0 ? -1 : text.parents[middle];
  if (root < 0) fail(text, fmt::format("{}: no node above the joints", name));
  read_figures(text, text.document.at("nodes")[root], out.body);
  check_body(out.body, fmt::format("{}: {}", printable(text.file.string()), printable(name)));
  return out;
} catch (const nlohmann::json::exception& e) {
  throw InputError(fmt::format("{}: {}: damaged: {}", printable(crowd.text->file.string()),
                               printable(name), printable(e.what())));
}

}  // namespace ecorche::inline v1
