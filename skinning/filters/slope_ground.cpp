#include "skinning/filters/slope_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "skinning/constraints/foot_contacts.h"
#include "skinning/constraints/leg_ik.h"
#include "skinning/constraints/temporal_smoothing.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kWay = 0.3;         // m; a shorter one has no direction
constexpr double kStraight = 0.998;  // of its length, to which a leg extends
constexpr double kSinking = 0.15;    // s; width of the pelvis' temporal smoothing

// Where a foot is to be.
struct FootGoal {
  Transform subtalar;
  Vec3 ankle;  // where it would be with the foot turned as a whole
};

void put_foot(const Skeleton& skeleton, const FootShape& foot, const FootGoal& goal, Pose& pose,
              std::vector<Transform>& X) {
  Vec3 ankle = goal.ankle;
  // The subtalar joint moves with the talus, whose rotation is part of the solution.
  for (int round = 0; round < 6; ++round) {
    reach_with_leg(skeleton, foot, ankle, goal.subtalar.linear(), pose, X);
    ankle += goal.subtalar.translation() - X[std::size_t(foot.subtalar)].translation();
  }
}

}  // namespace

Transform slope_of(const Motion& level, double angle) {
  const Vec3 first = level.frames.front().root;
  Vec3 way = level.frames.back().root - first;
  way.y() = 0;
  if (way.norm() < kWay) way = ground_place(level.frames.front()).turned(Vec3::UnitZ());
  const Vec3 across = way.normalized().cross(Vec3::UnitY()), about(first.x(), 0, first.z());
  Transform out = Transform::Identity();
  out.linear() = Eigen::AngleAxisd(angle, across).toRotationMatrix();
  out.translation() = about - out.linear() * about;
  return out;
}

void put_on_slope(const Skeleton& skeleton, double sole_height, double angle, Motion& motion) {
  if (motion.frames.empty() || angle == 0) return;
  const Transform slope = slope_of(motion, angle);
  const std::array<FootShape, 2> feet = {foot_shape(skeleton, Side::left, sole_height),
                                         foot_shape(skeleton, Side::right, sole_height)};
  std::vector<std::array<FootGoal, 2>> goals;
  std::vector<double> sunk;
  std::vector<Transform> X;
  for (Pose& pose : motion.frames) {
    forward_kinematics(skeleton, pose, X);
    std::array<FootGoal, 2> goal;
    for (std::size_t s = 0; s < 2; ++s)
      goal[s] = {slope * X[std::size_t(feet[s].subtalar)],
                 slope * X[std::size_t(feet[s].ankle)].translation()};
    const double height = pose.root.y();
    pose.root = slope * Vec3(pose.root.x(), 0, pose.root.z());
    pose.root.y() += height;
    forward_kinematics(skeleton, pose, X);
    double low = 0;
    for (std::size_t s = 0; s < 2; ++s) {
      const Vec3 hip = X[std::size_t(feet[s].hip)].translation();
      const double reach = kStraight * straight_leg(skeleton, feet[s], X);
      low = std::max(low, hip_drop(hip, goal[s].ankle, reach));
    }
    goals.push_back(goal);
    sunk.push_back(low);
  }
  smooth_maximum(std::max(1, int(std::lround(kSinking * motion.fps))), sunk, std::greater<>());
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    Pose& pose = motion.frames[f];
    pose.root.y() -= sunk[f];
    forward_kinematics(skeleton, pose, X);
    for (std::size_t s = 0; s < 2; ++s) put_foot(skeleton, feet[s], goals[f][s], pose, X);
    complete_pose(skeleton, pose);
  }
}

}  // namespace ecorche::inline v1
