#include "morph/placement/fitted_skeleton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/errors.h"
#include "anatomy/joint_angles.h"

namespace ecorche::inline v1 {
namespace {

Vec3 mirrored(const Vec3& x, double plane) { return {2 * plane - x.x(), x.y(), x.z()}; }

Mat3 mirrored(const Mat3& turn) {
  const Mat3 M = Vec3(-1, 1, 1).asDiagonal();
  return M * turn * M;
}

Mat3 turn_of(const BoneMap& map) { return map.target_frame * map.frame.transpose(); }

// Angles of a body's rest pose. A body stands upright at rest, so that its trunk is at the
// anatomical zero, however its spine curves; of what its limbs are turned by, posture is what lies
// inside the limits, the rest (carrying angle, knock knees) is its shape.
Vec3 rest_angles(const Joint& joint, const Mat3& turn) {
  if (split_side(joint.name).second == Side::middle) return Vec3::Zero();
  return joint_angles(joint, Quat(turn)).cwiseMax(joint.min).cwiseMin(joint.max);
}

}  // namespace

SkeletonWarp::SkeletonWarp(const Anatomy& source, const FitRules& rules, SidedPlacement placement)
    : source_(source),
      rules_(rules),
      placement_(std::move(placement)),
      joints_(source.skeleton.joints.size()) {
  for (size_t j = 0; j < joints_.size(); ++j)
    joints_[j].side = split_side(source.skeleton.joints[j].name).second;
  for (const Bone& bone : source.bones) {
    const auto group = rules.group_of_bone.find(split_side(bone.name).first);
    if (group == rules.group_of_bone.end())
      throw UnfitError(fmt::format("bone '{}' is in no group of bone_groups.csv", bone.name));
    bone_groups_.push_back(group->second);
    JointWarp& joint = joints_[bone.joint];
    auto at = std::find(joint.groups.begin(), joint.groups.end(), group->second);
    if (at == joint.groups.end()) {
      at = joint.groups.insert(at, group->second);
      joint.samples.emplace_back();
    }
    Points& samples = joint.samples[at - joint.groups.begin()];
    const std::vector<int> chosen = surface_samples(bone.mesh, 40);
    const Eigen::Index first = samples.rows();
    samples.conservativeResize(first + Eigen::Index(chosen.size()), 3);
    for (size_t k = 0; k < chosen.size(); ++k)
      samples.row(first + Eigen::Index(k)) = bone.mesh.V.row(chosen[k]);
  }
  for (size_t j = 0; j < joints_.size();
       ++j) {  // joints without bones (subtalar has; none today) follow their parents
    if (joints_[j].groups.empty() && source.skeleton.joints[j].parent >= 0)
      joints_[j].groups = {joints_[source.skeleton.joints[j].parent].groups[0]};
  }
}

Vec3 SkeletonWarp::by_group(int group, Side side, const Vec3& x) const {
  if (side ==
      Side::middle) {  // paired bones of a middle group (pelvis, ribs) lie on both sides of it
    side = x.x() >= placement_.source_plane ? Side::left : Side::right;
  }
  const Vec3 out = placement_.turn(
      side == Side::left
          ? placement_.left.maps[group](x)
          : mirrored(placement_.right.maps[group](mirrored(x, placement_.source_plane)),
                     placement_.target_plane));
  if (placement_.pushes.empty()) return out;
  const bool right = side == Side::right && rules_.groups[group].paired;
  return pushed(placement_.pushes[group][right], placement_.target_plane, out);
}

Vec3 SkeletonWarp::by_bone(int bone, const Vec3& x) const {
  return by_group(bone_groups_[bone], source_.bones[bone].side, x);
}

Vec3 SkeletonWarp::by_joint(int joint, const Vec3& x) const {
  const JointWarp& warp = joints_[joint];
  if (warp.groups.size() == 1) return by_group(warp.groups[0], warp.side, x);
  constexpr double kNear2 = 4e-6;  // m^2: within 2 mm of a bone only that bone counts
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (size_t k = 0; k < warp.groups.size(); ++k) {
    const double d2 =
        (warp.samples[k].rowwise() - x.transpose()).rowwise().squaredNorm().minCoeff() + kNear2;
    const double weight = 1 / (d2 * d2);
    sum += weight * by_group(warp.groups[k], warp.side, x);
    total += weight;
  }
  return sum / total;
}

Anatomy SkeletonWarp::skeleton() const {
  Anatomy out;
  out.skeleton = source_.skeleton;
  const std::vector<Vec3> rest = rest_positions(source_.skeleton);
  std::vector<Vec3> centres(rest.size());
  std::vector<Mat3> turns(rest.size());
  for (size_t j = 0; j < rest.size(); ++j) {
    const auto [name, side] = split_side(source_.skeleton.joints[j].name);
    centres[j] = by_group(joints_[j].groups[0], side, rest[j]);
    for (const ContactRule& contact : rules_.contacts)
      if (contact.point == name)
        centres[j] = (by_group(contact.a, side, rest[j]) + by_group(contact.b, side, rest[j])) / 2;
    if (side == Side::middle)
      centres[j].x() =
          placement_.turn(Vec3(placement_.target_plane, centres[j].y(), centres[j].z())).x();
    turns[j] = side == Side::right ? mirrored(turn_of(placement_.right.maps[joints_[j].groups[0]]))
                                   : turn_of(placement_.left.maps[joints_[j].groups[0]]);
  }
  for (size_t j = 0; j < rest.size(); ++j) {
    Joint& joint = out.skeleton.joints[j];
    const Mat3 before = source_.skeleton.joints[j].axes;
    const Mat3 parent = joint.parent >= 0 ? turns[joint.parent] : Mat3::Identity();
    joint.X_PJ = Transform::Identity();
    joint.X_PJ.translation() =
        joint.parent >= 0 ? Vec3(centres[j] - centres[joint.parent]) : centres[j];
    joint.axes = parent * before;
    joint.zero = rest_angles(source_.skeleton.joints[j], parent.transpose() * turns[j]);
  }
  for (size_t b = 0; b < source_.bones.size(); ++b) {
    Bone bone = source_.bones[b];
    for (Eigen::Index i = 0; i < bone.mesh.V.rows(); ++i)
      bone.mesh.V.row(i) = by_bone(int(b), bone.mesh.V.row(i));
    out.bones.push_back(std::move(bone));
  }
  return out;
}

}  // namespace ecorche::inline v1
