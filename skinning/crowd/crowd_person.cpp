#include "skinning/crowd/crowd_person.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "skinning/crowd/crowd_layout.h"
#include "skinning/files/glb_builder.h"

namespace ecorche::inline v1 {
namespace {

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

}  // namespace

void write_crowd_person(const std::filesystem::path& file, const CrowdPrototype& prototype,
                        const Character& character,
                        std::span<const std::array<Influence, 4>> weights) {
  AtomicFile out(file);
  const CrowdLayout layout = crowd_layout(prototype);
  const std::vector<TriMesh> meshes = crowd_meshes(
      character, prototype.layers.size() == 1 ? CrowdLayers::skin_alone : CrowdLayers::all);
  bool same = same_joints(prototype.skeleton, character.anatomy.skeleton);
  double reach = 1;  // m; who has no more is kept in metres
  for (std::size_t l = 0; l < meshes.size(); ++l) {
    same = same && std::size_t(meshes[l].V.rows()) == layout.layers[l].vertices &&
           meshes[l].F.rows() == prototype.layers[l].F.rows() &&
           meshes[l].F == prototype.layers[l].F;
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
  const QuantizedWeights shares = quantize_weights(weights);
  put(bytes, layout.joints, shares.joints.data(), shares.joints.size());
  put(bytes, layout.weights, shares.weights.data(), 2 * shares.weights.size());
  for (std::size_t l = 0; l < meshes.size(); ++l)
    put_mesh(bytes, layout.layers[l].positions, layout.layers[l].normals, meshes[l], double(unit));
  out.stream().write(bytes.data(), std::streamsize(bytes.size()));
  if (!out.stream()) out.fail();
  out.commit();
}

}  // namespace ecorche::inline v1
