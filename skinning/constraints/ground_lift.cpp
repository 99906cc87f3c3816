#include "skinning/constraints/ground_lift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "anatomy/chain_kinematics.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/constraints/temporal_smoothing.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kLeft = 0.002;   // m; shallower soles stay
constexpr double kMost = 0.1;     // m
constexpr double kRising = 0.12;  // s to either side

}  // namespace

double lift_from_ground(const Skeleton& skeleton, double sole_height,
                        std::span<const GroundHeights> heights, Motion& motion) {
  const std::array<FootShape, 2> feet = {foot_shape(skeleton, Side::left, sole_height),
                                         foot_shape(skeleton, Side::right, sole_height)};
  const std::vector<int> joints = feet_joints(skeleton);
  std::vector<double> lift;
  std::vector<Transform> X;
  for (const Pose& pose : motion.frames) {
    chain_kinematics(skeleton, joints, pose, X);
    double low = 0;
    for (const FootShape& foot : feet) {
      const FootPoints at = foot_points(skeleton, foot, X);
      low = std::min({low, at.heel.y(), at.ball.y(), at.tip.y()});
    }
    lift.push_back(-low);
  }
  for (std::size_t f = 0; f < heights.size(); ++f)
    lift[f] = -std::min({-lift[f], heights[f].least(), heights[f].feet[0], heights[f].feet[1]});
  for (double& one : lift) one = one > kLeft ? std::min(kMost, one) : 0;
  const double most = lift.empty() ? 0 : *std::ranges::max_element(lift);
  if (most == 0) return 0;
  smooth_maximum(std::max(1, int(std::lround(kRising * motion.fps))), lift, std::greater<>());
  for (std::size_t f = 0; f < lift.size(); ++f) motion.frames[f].root.y() += lift[f];
  return most;
}

}  // namespace ecorche::inline v1
