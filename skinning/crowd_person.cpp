// The mould and a person's own bytes. The file around them is in crowd_file.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "anatomy/join_meshes.h"
#include "anatomy/muscle_line.h"
#include "anatomy/muscle_surface.h"
#include "skinning/crowd_layout.h"
#include "skinning/glb_builder.h"
#include "skinning/slice_influences.h"

namespace ecorche {
namespace {

MuscleSurface crowd_surface(const Anatomy& anatomy) {
  MuscleSurfaceOptions options;
  options.points_per_slice = 8;  // people of a crowd are seen from afar
  return make_muscle_surface(anatomy, options);
}

std::array<TriMesh, 3> layer_meshes(const Character& character, const MuscleSurface& surface) {
  std::vector<const TriMesh*> bones;
  for (const Bone& bone : character.anatomy.bones) bones.push_back(&bone.mesh);
  std::array<TriMesh, 3> out{character.body.skin, join_meshes(bones), TriMesh{Points(), surface.F}};
  update_muscle_surface(surface, rest_slices(character.anatomy), out[2].V);
  return out;
}

bool same_joints(const Skeleton& a, const Skeleton& b) {
  return std::equal(a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(),
                    [](const Joint& l, const Joint& r) { return l.name == r.name && l.parent == r.parent; });
}

void put(std::span<char> bytes, std::size_t at, const void* values, std::size_t size) { std::memcpy(bytes.data() + at, values, size); }

void put_inverse_binds(std::span<char> bytes, const Skeleton& skeleton, float scale) {
  const std::vector<Vec3> places = rest_positions(skeleton);
  for (std::size_t j = 0; j < places.size(); ++j) {
    Eigen::Matrix4f inverse = Eigen::Matrix4f::Identity();
    inverse.diagonal().head<3>().setConstant(scale);
    inverse.col(3).head<3>() = (kCrowdCentre - places[j]).cast<float>();
    put(bytes, kMatrixBytes * j, inverse.data(), kMatrixBytes);
  }
}

void put_mesh(std::span<char> bytes, std::size_t positions, std::size_t normals, const TriMesh& mesh, double scale) {
  const Points directions = gltf::GlbBuilder::unit_normals(mesh);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    std::int16_t place[4]{};
    std::int8_t direction[4]{};
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = static_cast<std::int16_t>(std::clamp(std::lround((mesh.V(v, axis) - kCrowdCentre[axis]) / scale), -32767L, 32767L));
      direction[axis] = static_cast<std::int8_t>(std::lround(127 * directions(v, axis)));
    }
    put(bytes, positions + kPositionBytes * static_cast<std::size_t>(v), place, kPositionBytes);
    put(bytes, normals + kNormalBytes * static_cast<std::size_t>(v), direction, kNormalBytes);
  }
}

}  // namespace

CrowdMould make_crowd_mould(const Character& character, const Binding& binding) {
  if (character.anatomy.skeleton.joints.size() > 256) throw LimitError("a crowd's people have at most 256 joints");
  if (binding.joint_weights.size() != static_cast<std::size_t>(character.body.skin.V.rows()))
    throw std::invalid_argument("make_crowd_mould: the binding is of another skin");
  CrowdMould out;
  out.skeleton = character.anatomy.skeleton;
  const MuscleSurface surface = crowd_surface(character.anatomy);
  std::array<TriMesh, 3> meshes = layer_meshes(character, surface);
  static constexpr const char* kNames[] = {"skin", "bones", "muscles"};
  for (std::size_t l = 0; l < 3; ++l) out.layers[l].name = kNames[l], out.layers[l].F = std::move(meshes[l].F);

  out.layers[0].influences = binding.joint_weights;
  for (const Bone& bone : character.anatomy.bones) {
    const auto begin = static_cast<int>(out.layers[1].influences.size()), end = begin + static_cast<int>(bone.mesh.V.rows());
    out.layers[1].parts.push_back({bone.name, begin, end});
    out.layers[1].influences.resize(static_cast<std::size_t>(end), {Influence{bone.joint, 1}});
  }
  const std::vector<std::array<Influence, 4>> by_slice = slice_influences(character.anatomy);
  for (int slice : surface.slice) out.layers[2].influences.push_back(by_slice[static_cast<std::size_t>(slice)]);
  for (const MuscleSurface::Part& part : surface.parts)
    out.layers[2].parts.push_back({character.anatomy.muscles[static_cast<std::size_t>(part.muscle)].name, part.vertex_begin, part.vertex_end});
  return out;
}

void write_crowd_person(const std::filesystem::path& file, const CrowdMould& mould, const Character& character) {
  AtomicFile out(file);
  const std::array<TriMesh, 3> meshes = layer_meshes(character, crowd_surface(character.anatomy));
  const CrowdLayout layout = crowd_layout(mould);
  bool same = same_joints(mould.skeleton, character.anatomy.skeleton);
  double reach = 0;
  for (std::size_t l = 0; l < 3; ++l) {
    same = same && static_cast<std::size_t>(meshes[l].V.rows()) == layout.vertices[l] && meshes[l].F.rows() == mould.layers[l].F.rows() &&
           meshes[l].F == mould.layers[l].F;
    reach = std::max(reach, (meshes[l].V.rowwise() - kCrowdCentre.transpose()).cwiseAbs().maxCoeff());
  }
  if (!same) throw UnfitError(fmt::format("{}: not made from the template of the crowd; its joints or triangles are others", character.body.name));
  const auto scale = static_cast<float>(reach / 32766);
  std::vector<char> bytes(layout.size);
  put_inverse_binds(bytes, character.anatomy.skeleton, scale);
  for (std::size_t l = 0; l < 3; ++l) put_mesh(bytes, layout.positions[l], layout.normals[l], meshes[l], static_cast<double>(scale));
  out.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out.stream()) throw OutputError(fmt::format("{}: could not be written", file.string()));
  out.commit();
}

}  // namespace ecorche
