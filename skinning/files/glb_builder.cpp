#include "skinning/files/glb_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "anatomy/errors.h"
#include "skinning/files/gltf_values.h"
#include "skinning/files/quantized_rotations.h"

namespace ecorche::inline v1::gltf {

GlbBuilder::GlbBuilder() {
  model_.asset.version = "2.0";
  model_.asset.generator = fmt::format("ecorche {}", ECORCHE_VERSION);
  model_.buffers.emplace_back();
  model_.scenes.emplace_back();
  model_.defaultScene = 0;
}

std::array<double, 4> base_color(const TissueLook& look) {
  const Rgb light = linear_light(look.color);
  return {light.x(), light.y(), light.z(), 1};
}

int GlbBuilder::material(const TissueLook& look, float brighter) {
  for (std::size_t i = 0; i < model_.materials.size(); ++i)
    if (model_.materials[i].name == look.name) return int(i);
  TissueLook shown = look;
  shown.color *= brighter;
  const std::array<double, 4> color = base_color(shown);
  tinygltf::Material material;
  material.name = look.name;
  material.pbrMetallicRoughness.baseColorFactor.assign(color.begin(), color.end());
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = double(look.roughness);
  model_.materials.push_back(std::move(material));
  return int(model_.materials.size()) - 1;
}

int GlbBuilder::add_indices(const Triangles& F) {
  const std::vector<std::uint32_t> indices(F.data(), F.data() + F.size());
  return add_accessor(indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, 1,
                      TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
}

tinygltf::Primitive GlbBuilder::surface(const Points& V, const Points& normals, int indices,
                                        int material) {
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = material;
  primitive.attributes["POSITION"] = add_vectors(V, true);
  primitive.attributes["NORMAL"] = add_vectors(normals, false);
  primitive.indices = indices;
  return primitive;
}

int GlbBuilder::add_mesh(const std::string& name, std::vector<tinygltf::Primitive> primitives) {
  tinygltf::Mesh out;
  out.name = name;
  out.primitives = std::move(primitives);
  model_.meshes.push_back(std::move(out));
  return int(model_.meshes.size()) - 1;
}

tinygltf::Primitive& GlbBuilder::add_mesh(const std::string& name, const TriMesh& mesh,
                                          int material) {
  add_mesh(name, {surface(mesh.V, unit_normals(mesh), add_indices(mesh.F), material)});
  return model_.meshes.back().primitives[0];
}

void GlbBuilder::add_influences(tinygltf::Primitive& primitive,
                                std::span<const std::array<Influence, 4>> influences) {
  std::vector<std::uint16_t> joints;
  std::vector<float> weights;
  for (const auto& four : influences) {
    float sum = 0;
    for (const Influence& influence : four) sum += float(influence.weight);
    for (const Influence& influence : four) {
      const float weight = float(influence.weight) / sum;
      joints.push_back(weight > 0 ? std::uint16_t(influence.joint)
                                  : 0);  // an unused slot must name joint 0
      weights.push_back(weight);
    }
  }
  primitive.attributes["JOINTS_0"] =
      add_accessor(joints, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, 4,
                   TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.attributes["WEIGHTS_0"] = add_accessor(
      weights, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4, 4, TINYGLTF_TARGET_ARRAY_BUFFER);
}

Points GlbBuilder::unit_normals(const TriMesh& mesh) {
  Points normals = Points::Zero(mesh.V.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    const Vec3 n = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) normals.row(mesh.F(f, k)) += n.transpose();
  }
  for (Eigen::Index i = 0; i < normals.rows(); ++i) {
    const double length = normals.row(i).norm();
    if (length > 1e-30)
      normals.row(i) /= length;
    else
      normals.row(i) << 0, 1,
          0;  // glTF asks for unit length; a vertex without area has no better direction
  }
  return normals;
}

size_t GlbBuilder::align() {
  auto& bytes = model_.buffers[0].data;
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes.size();
}

int GlbBuilder::add_node(tinygltf::Node node, int parent) {
  const int index = model_.nodes.size();
  model_.nodes.push_back(std::move(node));
  (parent < 0 ? scene().nodes : model_.nodes[parent].children).push_back(index);
  return index;
}

tinygltf::Value GlbBuilder::keep_text(std::string json) {
  texts_.push_back(std::move(json));
  return tinygltf::Value(int(texts_.size()) - 1);
}

namespace {

void write_number(std::ostream& out, std::size_t value) {
  if (value > std::numeric_limits<std::uint32_t>::max())
    throw LimitError("a .glb file holds at most 4 GB");
  const std::uint32_t number = value;
  out.write(reinterpret_cast<const char*>(&number), sizeof number);
}

// Copies `from` up to where `place` stands and `instead` in place of it. No text of a user's looks
// like a place: in there a quotation mark follows a backslash.
void replace_next(const std::string& from, const std::string& place, const std::string& instead,
                  std::size_t& at, std::string& to) {
  const std::size_t found = from.find(place, at);
  if (found == std::string::npos)
    throw std::logic_error(fmt::format("GlbBuilder: {} is nowhere", place));
  to.append(from, at, found - at);
  to += instead;
  at = found + place.size();
}

}  // namespace

bool GlbBuilder::write(std::ostream& out) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8, kVersion = 2, kJson = 0x4E4F534A,
                        kBinary = 0x004E4942;
  // Without its bytes, which would be copied twice.
  const std::size_t length = align();
  std::vector<unsigned char> bytes;
  bytes.swap(model_.buffers[0].data);
  std::ostringstream written;
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, written, false, true)) return false;
  const std::string model = std::move(written).str();
  std::string json;
  std::size_t at = kHeader + kChunkHeader;
  replace_next(model, R"("buffers":[{"byteLength":0)",
               fmt::format(R"("buffers":[{{"byteLength":{})", length), at, json);
  for (std::size_t n = 0; n < texts_.size(); ++n)
    replace_next(model, fmt::format(R"("strips":{},)", n),
                 fmt::format(R"("strips":{},)", texts_[n]), at, json);
  json.append(model, at);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  out.write("glTF", 4);
  for (const std::size_t number :
       {kVersion, kHeader + 2 * kChunkHeader + json.size() + bytes.size(), json.size(), kJson})
    write_number(out, number);
  out.write(json.data(), std::streamsize(json.size()));
  for (const std::size_t number : {bytes.size(), kBinary}) write_number(out, number);
  out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  return static_cast<bool>(out);
}

int GlbBuilder::add_vectors(const Points& points, bool bounds) {
  std::vector<float> values(points.size());
  for (Eigen::Index i = 0; i < points.size(); ++i) values[i] = float(points.data()[i]);
  return add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3,
                      TINYGLTF_TARGET_ARRAY_BUFFER, bounds);
}

int GlbBuilder::add_scalars(const std::vector<float>& values, bool bounds, int target) {
  return add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, 1, target,
                      bounds);
}

int GlbBuilder::add_texture_coordinates(const TexturePoints& places) {
  std::vector<float> values;
  for (Eigen::Index i = 0; i < places.rows(); ++i)
    values.insert(values.end(), {places(i, 0), 1 - places(i, 1)});
  return add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, 2,
                      TINYGLTF_TARGET_ARRAY_BUFFER);
}

int GlbBuilder::add_tints(const std::vector<Tint>& tints) {
  std::vector<std::uint8_t> values;
  for (const Tint& tint : tints) values.insert(values.end(), tint.begin(), tint.end());
  const int accessor = add_accessor(values, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                                    TINYGLTF_TYPE_VEC4, 4, TINYGLTF_TARGET_ARRAY_BUFFER);
  model_.accessors.back().normalized = true;
  return accessor;
}

int GlbBuilder::add_normalized_shorts(const std::vector<std::int16_t>& values, int type,
                                      int components) {
  const int accessor = add_accessor(values, TINYGLTF_COMPONENT_TYPE_SHORT, type, components, 0);
  model_.accessors.back().normalized = true;
  return accessor;
}

namespace {

std::vector<double> to_vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

void add_joints(GlbBuilder& glb, const Skeleton& skeleton) {
  for (const Joint& joint : skeleton.joints) {
    tinygltf::Node node;
    node.name = joint.name;
    node.translation = to_vector(joint.X_PJ.translation());
    node.extras = joint_extras(joint);
    glb.add_node(std::move(node), joint.parent);
  }
  tinygltf::Skin skin;
  skin.name = "joints";
  skin.skeleton = 0;
  std::vector<float> inverse_binds;
  for (size_t j = 0; j < skeleton.joints.size(); ++j) {
    skin.joints.push_back(int(j));
    Eigen::Matrix4f inverse = Eigen::Matrix4f::Identity();
    inverse.col(3).head<3>() = -rest_positions(skeleton)[j].cast<float>();
    inverse_binds.insert(inverse_binds.end(), inverse.data(), inverse.data() + 16);
  }
  skin.inverseBindMatrices =
      glb.add_accessor(inverse_binds, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_MAT4, 16, 0);
  glb.model().skins.push_back(skin);
}

void add_channel(tinygltf::Animation& animation, int node, const char* path, int times,
                 int values) {
  animation.samplers.push_back({});
  animation.samplers.back().input = times;
  animation.samplers.back().output = values;
  animation.samplers.back().interpolation = "LINEAR";
  animation.channels.push_back({});
  animation.channels.back().sampler = int(animation.samplers.size()) - 1;
  animation.channels.back().target_node = node;
  animation.channels.back().target_path = path;
}

namespace {

int add_turns(GlbBuilder& glb, std::span<const Quat> turns, RotationKeys keys) {
  if (keys == RotationKeys::shorts) {
    std::vector<std::int16_t> values;
    for (const Quat& q : turns)
      for (const std::int16_t part : quantize(q)) values.push_back(part);
    return glb.add_normalized_shorts(values, TINYGLTF_TYPE_VEC4, 4);
  }
  std::vector<float> values;
  for (const Quat& q : turns)
    for (const double part : q.coeffs()) values.push_back(float(part));
  return glb.add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4, 4, 0);
}

}  // namespace

int add_motion(GlbBuilder& glb, const Skeleton& skeleton, const Motion& motion,
               const std::string& name, RotationKeys keys) {
  constexpr float kStill = 5e-7f;  // of a quaternion's parts
  tinygltf::Animation animation;
  animation.name = name;
  std::vector<float> seconds, roots;
  for (size_t f = 0; f < motion.frames.size(); ++f) {
    seconds.push_back(float(double(f) / motion.fps));
    for (int k = 0; k < 3; ++k) roots.push_back(float(motion.frames[f].root[k]));
  }
  const int times = glb.add_scalars(seconds, true, 0);
  int begin = -1;  // of what does not move: one key
  add_channel(animation, 0, "translation", times,
              glb.add_accessor(roots, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3, 0));
  for (size_t j = 0; j < skeleton.joints.size(); ++j) {
    const std::vector<Quat> turns = continuous_rotations(motion, j);
    const bool turned = std::any_of(turns.begin(), turns.end(),
                                    [](const Quat& q) { return std::abs(q.w()) < 1 - 1e-12; });
    const bool moves = std::any_of(turns.begin(), turns.end(), [&](const Quat& q) {
      return (q.coeffs() - turns[0].coeffs()).cast<float>().cwiseAbs().maxCoeff() > kStill;
    });
    // A node that stands turned needs a key to stand straight.
    if (!turned && glb.model().nodes[j].rotation.empty()) continue;
    if (!moves && begin < 0) begin = glb.add_scalars({0}, true, 0);
    add_channel(animation, int(j), "rotation", moves ? times : begin,
                add_turns(glb, std::span(turns).first(moves ? turns.size() : 1), keys));
  }
  Object extras;
  extras["fps"] = number(motion.fps);
  animation.extras = tinygltf::Value(std::move(extras));
  glb.model().animations.push_back(std::move(animation));
  return times;
}

}  // namespace ecorche::inline v1::gltf
