#include "skinning/motion/limit_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/package_archive.h"
#include "anatomy/joint_angles.h"
#include "skinning/motion/name_pattern.h"
#include "skinning/motion/no_such_joint.h"
#include "skinning/motion/raise_arm.h"

namespace ecorche::inline v1 {
namespace {

bool is_meant(const std::string& pattern, const std::string& joint) {
  if (matches_pattern(pattern, joint)) return true;
  return (joint.ends_with("_l") || joint.ends_with("_r")) &&
         matches_pattern(pattern, std::string_view(joint).substr(0, joint.size() - 2));
}

double share(const Table& table, int row, const char* column) {
  const double value = table.number(row, column);
  if (!(value >= -1 && value <= 1))
    throw InputError(
        fmt::format("{}: {} {} is outside -1 .. 1; it is a share of the way to the limit",
                    table.where(row), column, value));
  return value;
}

// Shares of half a turn from hanging: forwards, to the side; of a quarter, outwards.
ArmDirection arm_direction(const Vec3& shares) {
  constexpr double kHalfTurn = std::numbers::pi;
  return {kHalfTurn * std::min(1.0, std::hypot(shares[0], shares[1])),
          std::atan2(shares[0], shares[1]), kHalfTurn / 2 * shares[2]};
}

}  // namespace

Quat limit_rotation(const Joint& joint, const Vec3& shares) {
  Vec3 angles = joint_angles(joint, Quat::Identity());
  for (int k = 0; k < 3; ++k) {
    if (shares[k] > 0) angles[k] += shares[k] * std::max(0.0, joint.max[k] - angles[k]);
    if (shares[k] < 0) angles[k] += -shares[k] * std::min(0.0, joint.min[k] - angles[k]);
  }
  return joint_rotation(joint, angles);
}

std::vector<LimitPose> read_limit_poses(const std::filesystem::path& file, const Skeleton& skeleton,
                                        UnknownJoints unknown) {
  return limit_poses(Table(file), printable(file.string()), skeleton, unknown);
}

std::vector<LimitPose> limit_poses(const Table& table, const std::string& name_of_table,
                                   const Skeleton& skeleton, UnknownJoints unknown) {
  std::vector<LimitPose> poses;
  for (int row = 0; row < table.rows(); ++row) {
    const Vec3 shares(share(table, row, "flexion"), share(table, row, "abduction"),
                      share(table, row, "rotation"));
    const std::string &name = table.text(row, "pose"), &pattern = table.text(row, "joint");
    if (name.empty() || pattern.empty())
      throw InputError(table.where(row) + ": a row needs the names of its pose and joint");
    const auto pose_of_row = [&]() -> Pose& {
      auto pose = std::find_if(poses.begin(), poses.end(),
                               [&](const LimitPose& p) { return p.name == name; });
      if (pose == poses.end())
        pose = poses.insert(poses.end(), LimitPose{name, rest_pose(skeleton)});
      return pose->pose;
    };
    bool meant = false;
    for (const Side side : {Side::left, Side::right}) {
      const bool named = pattern == "arm" || pattern == "arm" + std::string(side_suffix(side));
      if (!named || !has_arm(skeleton, side)) continue;
      meant = true;
      raise_arm(skeleton, side, arm_direction(shares), pose_of_row());
    }
    for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
      if (!is_meant(pattern, skeleton.joints[j].name)) continue;
      meant = true;
      pose_of_row().rotations[j] = limit_rotation(skeleton.joints[j], shares);
    }
    if (!meant && unknown == UnknownJoints::refuse)
      throw InputError(fmt::format("{}: {}", table.where(row), no_such_joint(skeleton, pattern)));
  }
  if (poses.empty()) throw InputError(fmt::format("{}: holds no poses", name_of_table));
  for (LimitPose& pose : poses) complete_pose(skeleton, pose.pose);
  return poses;
}

std::vector<LimitPose> standard_limit_poses(const std::filesystem::path& tables,
                                            const Skeleton& skeleton) {
  return read_limit_poses(tables / "poses.csv", skeleton, UnknownJoints::pass_over);
}

}  // namespace ecorche::inline v1
