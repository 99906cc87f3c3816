#include "skinning/constraints/ground_heights.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "anatomy/chain_kinematics.h"
#include "anatomy/compute/smooth_step.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kAside = 0, kDown = 0.25;  // cosines of a sole's tilt; toes that push off: 0.4
constexpr double kSeen = 0.3;               // m

struct Leg {
  std::size_t hip = 0, ankle = 0;
  double length = 1;  // m
};

Leg leg_of(const Skeleton& skeleton, Side side) {
  const auto at = [&](const char* stem) {
    return std::size_t(joint_of(skeleton, std::string(stem) + side_suffix(side)));
  };
  const auto reach = [&](const char* stem) {
    return skeleton.joints[at(stem)].X_PJ.translation().norm();
  };
  return {at("hip"), at("ankle"), reach("knee") + reach("ankle")};
}

double stretched(const Leg& leg, const std::vector<Transform>& X) {
  return (X[leg.hip].translation() - X[leg.ankle].translation()).norm() / leg.length;
}

}  // namespace

double height_over_ground(const std::vector<GroundPatch>& patches,
                          const std::vector<Transform>& X_WJ) {
  double low = kSeen;
  for (const GroundPatch& patch : patches) {
    const Transform& here = X_WJ[std::size_t(patch.joint)];
    const double height = here.translation().y();
    if (height > patch.reach + kSeen) continue;
    const Vec3 up = here.linear().row(1);
    for (const Vec3& p : patch.points) low = std::min(low, height + up.dot(p));
  }
  return low;
}

double share_on_sole(const Transform& foot) {
  return smooth_step(kAside, kDown, foot.linear()(1, 1));
}

double GroundHeights::least() const {
  return std::min({body, elbows[0], elbows[1], hands[0], hands[1]});
}

std::vector<int> joints_of(const Skeleton& skeleton,
                           const std::vector<const std::vector<GroundPatch>*>& patches) {
  std::vector<int> out;
  for (const std::vector<GroundPatch>* all : patches)
    for (const GroundPatch& patch : *all) out.push_back(patch.joint);
  return joints_up_from(skeleton, out);
}

std::vector<GroundHeights> ground_heights(const Skeleton& skeleton, const GroundPoints& points,
                                          const Motion& motion) {
  const std::vector<int> joints =
      joints_of(skeleton, {&points.body, &points.elbows[0], &points.elbows[1], &points.hands[0],
                           &points.hands[1], &points.fingers[0], &points.fingers[1],
                           &points.feet[0], &points.feet[1]});
  const std::array<Leg, 2> legs{leg_of(skeleton, Side::left), leg_of(skeleton, Side::right)};
  std::vector<GroundHeights> out;
  std::vector<Transform> X;
  for (const Pose& pose : motion.frames) {
    chain_kinematics(skeleton, joints, pose, X);
    GroundHeights& here = out.emplace_back();
    here.body = height_over_ground(points.body, X);
    for (std::size_t side = 0; side < 2; ++side) {
      here.feet[side] = height_over_ground(points.feet[side], X);
      if (!points.feet[side].empty()) here.stretched[side] = stretched(legs[side], X);
      here.elbows[side] = height_over_ground(points.elbows[side], X);
      here.hands[side] = std::min(height_over_ground(points.hands[side], X),
                                  height_over_ground(points.fingers[side], X));
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
