// The mould and a person's own bytes. The file around them is in crowd_file.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "skinning/crowd/crowd_layout.h"
#include "skinning/files/glb_builder.h"
#include "skinning/files/slice_influences.h"

namespace ecorche {
namespace {

MuscleSurface crowd_surface(const Anatomy& anatomy) {
  MuscleSurfaceOptions options;
  options.points_per_slice = 8;  // people of a crowd are seen from afar
  return make_muscle_surface(anatomy, options);
}

// As many as the crowd has layers: skin, bones, muscles.
std::vector<TriMesh> layer_meshes(const Character& character, CrowdLayers layers) {
  if (layers == CrowdLayers::skin_alone) return {character.body.skin};
  std::vector<const TriMesh*> bones;
  for (const Bone& bone : character.anatomy.bones) bones.push_back(&bone.mesh);
  const MuscleSurface surface = crowd_surface(character.anatomy);
  std::vector<TriMesh> out{character.body.skin, join_meshes(bones), TriMesh{Points(), surface.F}};
  update_muscle_surface(surface, rest_slices(character.anatomy), out[2].V);
  return out;
}

bool same_joints(const Skeleton& a, const Skeleton& b) {
  return std::equal(
      a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(),
      [](const Joint& l, const Joint& r) { return l.name == r.name && l.parent == r.parent; });
}

void put(std::span<char> bytes, std::size_t at, const void* values, std::size_t size) {
  std::memcpy(bytes.data() + at, values, size);
}

void put_inverse_binds(std::span<char> bytes, const Skeleton& skeleton, double unit) {
  const std::vector<Vec3> places = rest_positions(skeleton);
  for (std::size_t j = 0; j < places.size(); ++j) {
    Eigen::Matrix4f inverse = Eigen::Matrix4f::Identity();
    inverse.col(3).head<3>() = ((kCrowdMiddle - places[j]) / unit).cast<float>();
    put(bytes, kMatrixBytes * j, inverse.data(), kMatrixBytes);
  }
}

void put_joint_frames(std::span<char> bytes, std::size_t at, const Skeleton& skeleton) {
  for (const Joint& joint : skeleton.joints) {
    std::array<float, kFrameFloats> values;
    Eigen::Map<Eigen::Matrix3f>(values.data()) = joint.axes.cast<float>();
    Eigen::Map<Eigen::Matrix3f> angles(values.data() + 9);
    angles << joint.zero.cast<float>(), joint.min.cast<float>(), joint.max.cast<float>();
    put(bytes, at, values.data(), sizeof values);
    at += sizeof values;
  }
}

void put_mesh(std::span<char> bytes, std::size_t positions, std::size_t normals,
              const TriMesh& mesh, double unit) {
  const Points directions = gltf::GlbBuilder::unit_normals(mesh);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    std::int16_t place[4]{};
    std::int8_t direction[4]{};
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = std::int16_t(std::clamp(
          std::lround(32767 * (mesh.V(v, axis) - kCrowdMiddle[axis]) / unit), -32767L, 32767L));
      direction[axis] = static_cast<std::int8_t>(std::lround(127 * directions(v, axis)));
    }
    put(bytes, positions + kPositionBytes * std::size_t(v), place, kPositionBytes);
    put(bytes, normals + kNormalBytes * std::size_t(v), direction, kNormalBytes);
  }
}

void add_bones(const Anatomy& anatomy, CrowdMould::Layer& layer) {
  for (const Bone& bone : anatomy.bones) {
    const auto begin = int(layer.influences.size()), end = begin + int(bone.mesh.V.rows());
    layer.parts.push_back({bone.name, begin, end});
    layer.influences.resize(end, {Influence{bone.joint, 1}});
  }
}

void add_muscles(const Anatomy& anatomy, CrowdMould::Layer& layer) {
  const MuscleSurface surface = crowd_surface(anatomy);
  const std::vector<std::array<Influence, 4>> by_slice = slice_influences(anatomy);
  for (int slice : surface.slice) layer.influences.push_back(by_slice[slice]);
  for (const MuscleSurface::Part& part : surface.parts)
    layer.parts.push_back({anatomy.muscles[part.muscle].name, part.vertex_begin, part.vertex_end});
}

}  // namespace

CrowdShares crowd_shares(std::span<const std::array<Influence, 4>> influences) {
  CrowdShares out;
  for (const std::array<Influence, 4>& four : influences) {
    double sum = 0;
    for (const Influence& influence : four) sum += influence.weight;
    int left = 65535;
    std::array<int, 4> share{};
    std::size_t largest = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      share[k] = int(std::lround(65535 * four[k].weight / sum));
      left -= share[k];
      if (share[k] > share[largest]) largest = k;
    }
    share[largest] += left;
    for (std::size_t k = 0; k < 4; ++k) {
      out.joints.push_back(
          std::uint8_t(share[k] > 0 ? four[k].joint : 0));  // an unused slot must name joint 0
      out.weights.push_back(std::uint16_t(share[k]));
    }
  }
  return out;
}

CrowdMould make_crowd_mould(const Character& character, CrowdLayers layers) {
  if (character.anatomy.skeleton.joints.size() > 256)
    throw LimitError("a crowd's people have at most 256 joints");
  CrowdMould out;
  out.skeleton = character.anatomy.skeleton;
  static constexpr const char* kNames[] = {"skin", "bones", "muscles"};
  for (TriMesh& mesh : layer_meshes(character, layers)) {
    const std::size_t vertices = mesh.V.rows();
    out.layers.push_back({kNames[out.layers.size()], std::move(mesh.F), vertices, {}, {}});
  }
  if (layers == CrowdLayers::skin_alone) return out;
  add_bones(character.anatomy, out.layers[1]);
  add_muscles(character.anatomy, out.layers[2]);
  return out;
}

void write_crowd_person(const std::filesystem::path& file, const CrowdMould& mould,
                        const Character& character,
                        std::span<const std::array<Influence, 4>> weights) {
  AtomicFile out(file);
  const CrowdLayout layout = crowd_layout(mould);
  const std::vector<TriMesh> meshes = layer_meshes(
      character, mould.layers.size() == 1 ? CrowdLayers::skin_alone : CrowdLayers::all);
  bool same = same_joints(mould.skeleton, character.anatomy.skeleton);
  double reach = 1;  // m; who has no more is kept in metres
  for (std::size_t l = 0; l < meshes.size(); ++l) {
    same = same && std::size_t(meshes[l].V.rows()) == layout.layers[l].vertices &&
           meshes[l].F.rows() == mould.layers[l].F.rows() && meshes[l].F == mould.layers[l].F;
    reach =
        std::max(reach, (meshes[l].V.rowwise() - kCrowdMiddle.transpose()).cwiseAbs().maxCoeff());
  }
  if (!same)
    throw UnfitError(fmt::format(
        "{}: not made from the template of the crowd; its joints or triangles are others",
        character.body.name));
  if (weights.size() != layout.layers[0].vertices)
    throw std::invalid_argument("write_crowd_person: the weights are of another skin");
  const float unit = reach;
  std::vector<char> bytes(layout.size);
  put_inverse_binds(bytes, character.anatomy.skeleton, double(unit));
  put(bytes, layout.unit, &unit, sizeof unit);
  put_joint_frames(bytes, layout.frames, character.anatomy.skeleton);
  const CrowdShares shares = crowd_shares(weights);
  put(bytes, layout.joints, shares.joints.data(), shares.joints.size());
  put(bytes, layout.weights, shares.weights.data(), 2 * shares.weights.size());
  for (std::size_t l = 0; l < meshes.size(); ++l)
    put_mesh(bytes, layout.layers[l].positions, layout.layers[l].normals, meshes[l], double(unit));
  out.stream().write(bytes.data(), std::streamsize(bytes.size()));
  if (!out.stream()) out.fail();
  out.commit();
}

}  // namespace ecorche
