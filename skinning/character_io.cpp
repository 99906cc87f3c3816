// Writing. Reading is in character_read.cpp.
#include "skinning/character_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "anatomy/muscle_line.h"
#include "anatomy/muscle_surface.h"
#include "skinning/gltf_values.h"

namespace ecorche {
namespace {

using gltf::Object;
using tinygltf::Value;

constexpr std::array kSkinColour{0.80, 0.58, 0.47, 1.0};

// Builds the one buffer and the accessors over it.
class GlbBuilder {
 public:
  GlbBuilder() {
    model_.asset.version = "2.0";
    model_.asset.generator = fmt::format("ecorche {}", ECORCHE_VERSION);
    model_.buffers.emplace_back();
    model_.scenes.emplace_back();
    model_.defaultScene = 0;
  }

  tinygltf::Model& model() { return model_; }
  tinygltf::Scene& scene() { return model_.scenes[0]; }

  int add_node(tinygltf::Node node, int parent = -1) {
    const int index = static_cast<int>(model_.nodes.size());
    model_.nodes.push_back(std::move(node));
    (parent < 0 ? scene().nodes : model_.nodes[parent].children).push_back(index);
    return index;
  }

  template <class T>
  int add_accessor(const std::vector<T>& values, int component_type, int type, int components, int target, bool bounds = false) {
    const size_t start = align();
    auto& bytes = model_.buffers[0].data;
    bytes.resize(start + values.size() * sizeof(T));
    std::memcpy(bytes.data() + start, values.data(), values.size() * sizeof(T));

    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = start;
    view.byteLength = values.size() * sizeof(T);
    view.target = target;
    model_.bufferViews.push_back(view);

    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model_.bufferViews.size()) - 1;
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count = values.size() / components;
    if (bounds) {
      accessor.minValues.assign(components, std::numeric_limits<double>::infinity());
      accessor.maxValues.assign(components, -std::numeric_limits<double>::infinity());
      for (size_t i = 0; i < values.size(); ++i) {
        accessor.minValues[i % components] = std::min(accessor.minValues[i % components], double(values[i]));
        accessor.maxValues[i % components] = std::max(accessor.maxValues[i % components], double(values[i]));
      }
    }
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  int add_vectors(const Points& points, bool bounds) {
    std::vector<float> values(points.size());
    for (Eigen::Index i = 0; i < points.size(); ++i) values[i] = static_cast<float>(points.data()[i]);
    return add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3, TINYGLTF_TARGET_ARRAY_BUFFER, bounds);
  }

  int add_scalars(const std::vector<float>& values, bool bounds, int target) {
    return add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, 1, target, bounds);
  }

  int add_material(const std::string& name, std::array<double, 4> colour, double roughness) {
    tinygltf::Material material;
    material.name = name;
    material.pbrMetallicRoughness.baseColorFactor.assign(colour.begin(), colour.end());
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.roughnessFactor = roughness;
    model_.materials.push_back(std::move(material));
    return static_cast<int>(model_.materials.size()) - 1;
  }

  // A mesh with normals; the caller may add attributes to the returned primitive.
  tinygltf::Primitive& add_mesh(const std::string& name, const TriMesh& mesh, int material) {
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = material;
    primitive.attributes["POSITION"] = add_vectors(mesh.V, true);
    primitive.attributes["NORMAL"] = add_vectors(unit_normals(mesh), false);
    const std::vector<std::uint32_t> indices(mesh.F.data(), mesh.F.data() + mesh.F.size());
    primitive.indices =
        add_accessor(indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, 1, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    tinygltf::Mesh out;
    out.name = name;
    out.primitives.push_back(std::move(primitive));
    model_.meshes.push_back(std::move(out));
    return model_.meshes.back().primitives[0];
  }

  void add_influences(tinygltf::Primitive& primitive, std::span<const std::array<Influence, 4>> influences) {
    std::vector<std::uint16_t> joints;
    std::vector<float> weights;
    for (const auto& four : influences) {
      float sum = 0;
      for (const Influence& influence : four) sum += static_cast<float>(influence.weight);
      for (const Influence& influence : four) {
        const float weight = static_cast<float>(influence.weight) / sum;
        joints.push_back(weight > 0 ? static_cast<std::uint16_t>(influence.joint) : 0);  // an unused slot must name joint 0
        weights.push_back(weight);
      }
    }
    primitive.attributes["JOINTS_0"] =
        add_accessor(joints, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, 4, TINYGLTF_TARGET_ARRAY_BUFFER);
    primitive.attributes["WEIGHTS_0"] =
        add_accessor(weights, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4, 4, TINYGLTF_TARGET_ARRAY_BUFFER);
  }

  static Points unit_normals(const TriMesh& mesh) {
    Points normals = Points::Zero(mesh.V.rows(), 3);
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
      const Vec3 n = (b - a).cross(c - a);
      for (int k = 0; k < 3; ++k) normals.row(mesh.F(f, k)) += n.transpose();
    }
    for (Eigen::Index i = 0; i < normals.rows(); ++i) {
      const double length = normals.row(i).norm();
      if (length > 1e-30) normals.row(i) /= length;
      else normals.row(i) << 0, 1, 0;  // glTF asks for unit length; a vertex without area has no better direction
    }
    return normals;
  }

 private:
  size_t align() {
    auto& bytes = model_.buffers[0].data;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    return bytes.size();
  }

  tinygltf::Model model_;
};

std::vector<double> to_vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

// Joint nodes in skeleton order, so that node index = joint index.
void add_joints(GlbBuilder& glb, const Skeleton& skeleton) {
  for (const Joint& joint : skeleton.joints) {
    tinygltf::Node node;
    node.name = joint.name;
    node.translation = to_vector(joint.X_PJ.translation());
    node.extras = gltf::joint_extras(joint);
    glb.add_node(std::move(node), joint.parent);
  }
  tinygltf::Skin skin;
  skin.name = "joints";
  skin.skeleton = 0;
  std::vector<float> inverse_binds;
  for (size_t j = 0; j < skeleton.joints.size(); ++j) {
    skin.joints.push_back(static_cast<int>(j));
    Eigen::Matrix4f inverse = Eigen::Matrix4f::Identity();
    inverse.col(3).head<3>() = -rest_positions(skeleton)[j].cast<float>();
    inverse_binds.insert(inverse_binds.end(), inverse.data(), inverse.data() + 16);
  }
  skin.inverseBindMatrices = glb.add_accessor(inverse_binds, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_MAT4, 16, 0);
  glb.model().skins.push_back(skin);
}

void add_skin(GlbBuilder& glb, const Character& character, const Binding& binding) {
  const int material = glb.add_material("skin", kSkinColour, 0.6);
  tinygltf::Primitive& primitive = glb.add_mesh("skin", character.body.skin, material);
  glb.add_influences(primitive, binding.joint_weights);
  const int bones = static_cast<int>(character.anatomy.bones.size());
  std::vector<float> parts, distances;
  for (const Anchor& anchor : binding.anchors) {
    parts.push_back(static_cast<float>(anchor.kind == Anchor::Kind::muscle ? bones + anchor.part : anchor.part));
    distances.push_back(static_cast<float>(anchor.distance));
  }
  primitive.attributes["_ANCHOR_PART"] = glb.add_scalars(parts, false, TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.attributes["_ANCHOR_DISTANCE"] = glb.add_scalars(distances, false, TINYGLTF_TARGET_ARRAY_BUFFER);

  tinygltf::Node node;
  node.name = "skin";
  node.mesh = static_cast<int>(glb.model().meshes.size()) - 1;
  node.skin = 0;
  glb.add_node(std::move(node));
}

void add_bones(GlbBuilder& glb, const Anatomy& anatomy) {
  const int material = glb.add_material("bone", {0.89, 0.85, 0.76, 1}, 0.7);
  const auto positions = rest_positions(anatomy.skeleton);
  for (const Bone& bone : anatomy.bones) {
    TriMesh local = bone.mesh;
    local.V.rowwise() -= positions[bone.joint].transpose();
    glb.add_mesh("bone/" + bone.name, local, material);
    tinygltf::Node node;
    node.name = "bone/" + bone.name;
    node.mesh = static_cast<int>(glb.model().meshes.size()) - 1;
    node.extras = gltf::bone_extras(bone);
    glb.add_node(std::move(node), bone.joint);
  }
}

// What carries each slice: the carriers of the path points that its place on the line is a weighted sum of. #slices
std::vector<std::array<Influence, 4>> slice_influences(const Anatomy& anatomy) {
  std::vector<std::array<Influence, 4>> out;
  for (const Muscle& muscle : anatomy.muscles) {
    for (const Strip& strip : muscle.strips) {
      std::vector<double> s;
      for (const Slice& slice : strip.slices) s.push_back(slice.s);
      for (const LineNode& node : line_nodes(strip.path, s)) {
        std::map<int, double> shares;  // a spline's weights may be slightly negative, which influences must not be
        for (int i = 0; i < 4; ++i) {
          if (node.weight[i] == 0) continue;
          const PathPoint& p = strip.path[node.first + i];
          shares[p.joints[0]] += node.weight[i] * p.share;
          if (p.joints[1] >= 0) shares[p.joints[1]] += node.weight[i] * (1 - p.share);
        }
        std::vector<Influence> sorted;
        for (const auto& [joint, weight] : shares) sorted.push_back({joint, std::max(0.0, weight)});
        std::stable_sort(sorted.begin(), sorted.end(), [](const Influence& l, const Influence& r) { return l.weight > r.weight; });
        std::array<Influence, 4> four{};
        std::copy_n(sorted.begin(), std::min<size_t>(4, sorted.size()), four.begin());
        out.push_back(four);
      }
    }
  }
  return out;
}

void add_muscles(GlbBuilder& glb, const Anatomy& anatomy) {
  const int material = glb.add_material("muscle", {0.62, 0.16, 0.13, 1}, 0.5);
  const auto influences = slice_influences(anatomy);
  MuscleSurfaceOptions options;
  options.points_per_slice = 12;  // enough for the eye, and half the file
  const MuscleSurface surface = make_muscle_surface(anatomy, options);
  Points positions;
  update_muscle_surface(surface, rest_slices(anatomy), positions);
  for (const MuscleSurface::Part& part : surface.parts) {
    const Muscle& muscle = anatomy.muscles[part.muscle];
    tinygltf::Primitive& primitive = glb.add_mesh("muscle/" + muscle.name, part_mesh(surface, part, positions), material);
    std::vector<std::array<Influence, 4>> shares;
    for (int i = part.vertex_begin; i < part.vertex_end; ++i) shares.push_back(influences[surface.slice[i]]);
    glb.add_influences(primitive, shares);
    tinygltf::Node node;
    node.name = "muscle/" + muscle.name;
    node.mesh = static_cast<int>(glb.model().meshes.size()) - 1;
    node.skin = 0;
    node.extras = gltf::muscle_extras(muscle);
    glb.add_node(std::move(node));
  }
}

void add_channel(tinygltf::Animation& animation, int node, const char* path, int times, int values) {
  animation.samplers.push_back({});
  animation.samplers.back().input = times;
  animation.samplers.back().output = values;
  animation.samplers.back().interpolation = "LINEAR";
  animation.channels.push_back({});
  animation.channels.back().sampler = static_cast<int>(animation.samplers.size()) - 1;
  animation.channels.back().target_node = node;
  animation.channels.back().target_path = path;
}

void add_motion(GlbBuilder& glb, const Skeleton& skeleton, const Motion& motion) {
  tinygltf::Animation animation;
  animation.name = "motion";
  std::vector<float> seconds, roots;
  for (size_t f = 0; f < motion.frames.size(); ++f) {
    seconds.push_back(static_cast<float>(double(f) / motion.fps));
    for (int k = 0; k < 3; ++k) roots.push_back(static_cast<float>(motion.frames[f].root[k]));
  }
  const int times = glb.add_scalars(seconds, true, 0);
  add_channel(animation, 0, "translation", times, glb.add_accessor(roots, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3, 0));
  for (size_t j = 0; j < skeleton.joints.size(); ++j) {
    std::vector<float> turns;
    Quat last = Quat::Identity();
    bool moves = false;
    for (const Pose& pose : motion.frames) {
      Quat q = pose.rotations[j].normalized();
      if (q.dot(last) < 0) q.coeffs() = -q.coeffs();  // one hemisphere, so that linear players do not turn the long way round
      last = q;
      moves = moves || std::abs(q.w()) < 1 - 1e-12;
      for (int k = 0; k < 4; ++k) turns.push_back(static_cast<float>(q.coeffs()[k]));
    }
    if (!moves) continue;
    add_channel(animation, static_cast<int>(j), "rotation", times,
                glb.add_accessor(turns, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4, 4, 0));
  }
  Object extras;
  extras["fps"] = gltf::number(motion.fps);
  animation.extras = Value(std::move(extras));
  glb.model().animations.push_back(std::move(animation));
}

void finish(GlbBuilder& glb, const Body& body, const std::filesystem::path& file, AtomicFile& out) {
  Object ecorche{{"schema", Value(kCharacterSchema)}, {"body", gltf::body_extras(body)}};
  Object extras;
  extras["ecorche"] = Value(std::move(ecorche));
  glb.scene().extras = Value(std::move(extras));
  glb.scene().name = body.name.empty() ? "body" : body.name;
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&glb.model(), out.stream(), false, true))
    throw OutputError(fmt::format("{}: could not be written", file.string()));
  out.commit();
}

void check(const Character& character, const Binding& binding, const Motion* motion) {
  validate(character.anatomy);
  const size_t vertices = static_cast<size_t>(character.body.skin.V.rows());
  if (binding.joint_weights.size() != vertices || binding.anchors.size() != vertices)
    throw std::invalid_argument(fmt::format("write_character: binding of {} vertices for a skin of {}", binding.joint_weights.size(), vertices));
  if (character.anatomy.skeleton.joints.size() > 65535) throw LimitError("more than 65535 joints cannot be written as glTF");
  if (!motion) return;
  if (motion->frames.empty() || !(motion->fps > 0)) throw std::invalid_argument("write_character: a motion without frames or rate");
  for (const Pose& pose : motion->frames)
    if (pose.rotations.size() != character.anatomy.skeleton.joints.size())
      throw std::invalid_argument("write_character: the motion belongs to another skeleton");
}

}  // namespace

void write_character(const std::filesystem::path& file, const Character& character, const Binding& binding, const Motion* motion) {
  check(character, binding, motion);
  AtomicFile out(file);  // before the work, so that a bad place is told at once
  GlbBuilder glb;
  add_joints(glb, character.anatomy.skeleton);
  add_skin(glb, character, binding);
  add_bones(glb, character.anatomy);
  add_muscles(glb, character.anatomy);
  if (motion) add_motion(glb, character.anatomy.skeleton, *motion);
  finish(glb, character.body, file, out);
}

void write_body(const std::filesystem::path& file, const Body& body) {
  AtomicFile out(file);
  GlbBuilder glb;
  glb.add_mesh("skin", body.skin, glb.add_material("skin", kSkinColour, 0.6));
  tinygltf::Node node;
  node.name = "skin";
  node.mesh = 0;
  glb.add_node(std::move(node));
  finish(glb, body, file, out);
}

}  // namespace ecorche
