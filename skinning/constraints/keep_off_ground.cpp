#include "skinning/constraints/keep_off_ground.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>

#include "anatomy/chain_kinematics.h"
#include "anatomy/compute/smooth_step.h"
#include "anatomy/joint_angles.h"
#include "skinning/constraints/self_collision.h"
#include "skinning/constraints/temporal_smoothing.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kLeft = 0.002;  // m; what is shallower stays
constexpr double kArm = 0.06;    // m; an arm gives way by so much
constexpr double kLeg = 0.06;    // m; a bent leg raises its foot by so much
// Of its length: a leg that is stretched so far begins to give way by less, and gives way no more.
constexpr double kBent = 0.85, kStretched = 0.96;
constexpr double kMost = 0.2;            // m
constexpr double kRising = 0.12;         // s to either side
constexpr double kOpening = 0.1;         // s to either side
constexpr int kHalvings = 6;             // of the share by which fingers are straightened
constexpr double kBack = -20 * kDegree;  // flexion of a knuckle that is straightened wholly

using Patches = std::vector<GroundPatch>;

// Fingers and thumb of a hand from how they are to straight, then the hand to where its wrist is
// bent back, as one who leans on it has it.
class HandOpener {
 public:
  HandOpener(const Skeleton& skeleton, const GroundPoints& points, Side side)
      : skeleton_(skeleton),
        hand_(points.hands[side == Side::left ? 0 : 1]),
        fingers_(points.fingers[side == Side::left ? 0 : 1]),
        above_(joints_of(skeleton, {&hand_, &fingers_})),
        wrist_(std::size_t(joint_of(skeleton, std::string("wrist") + side_suffix(side)))) {
    for (int k = 1; k <= 5; ++k)
      for (const char* stem : {"mcp", "pip", "dip", "ip"})
        if (const int j = find_joint(skeleton, stem + std::to_string(k) + side_suffix(side));
            j >= 0)
          joints_.push_back(std::size_t(j));
  }

  // The least that keeps a hand out of the ground that is in it: to 1 of the fingers alone, to 2 of
  // the wrist, too, where that helps.
  double needed(const Pose& pose) {
    const double straight = low(pose, 1);
    double little = straight >= -kLeft ? 0 : 1, enough = little + 1;
    if (little == 1 && low(pose, 2) < straight + kLeft) return 1;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (enough + little);
      (low(pose, middle) >= -kLeft ? enough : little) = middle;
    }
    return enough;
  }

  void open(double share, Pose& pose) const {
    for (const std::size_t j : joints_)
      extend(j, std::min(1.0, share), skeleton_.joints[j].name.starts_with("mcp") ? kBack : 0,
             pose);
    if (share > 1) extend(wrist_, share - 1, skeleton_.joints[wrist_].min[0], pose);
  }

 private:
  double low(const Pose& pose, double share) {
    Pose trial = pose;
    open(share, trial);
    chain_kinematics(skeleton_, above_, trial, X_);
    return std::min(height_over_ground(hand_, X_), height_over_ground(fingers_, X_));
  }

  void extend(std::size_t j, double share, double flexion, Pose& pose) const {
    const Joint& joint = skeleton_.joints[j];
    Vec3 angles = joint_angles(joint, pose.rotations[j]);
    const double wanted = std::max(joint.min[0] + limit_ease(joint, 0), flexion);
    angles[0] += share * std::min(0.0, wanted - angles[0]);
    pose.rotations[j] = joint_rotation(joint, angles).normalized();
  }

  const Skeleton& skeleton_;
  const Patches &hand_, &fingers_;
  const std::vector<int> above_;
  const std::size_t wrist_;
  std::vector<std::size_t> joints_;
  std::vector<Transform> X_;
};

}  // namespace

bool renew_clearance(const std::vector<GroundHeights>& heights, bool whole, double fps,
                     GroundClearance& clearance) {
  const auto deep = [](const GroundHeights& one) {
    return std::min({one.least(), one.feet[0], one.feet[1]}) < -kLeft;
  };
  if (std::ranges::none_of(heights, deep)) return false;
  const std::size_t frames = heights.size();
  clearance.lift.resize(frames, 0.0);
  clearance.shifts.resize(frames);
  for (std::size_t f = 0; f < frames; ++f) {
    const GroundHeights& here = heights[f];
    LimbShifts& limbs = clearance.shifts[f];
    const double before = clearance.lift[f];
    // Of each part, by arm and figure together.
    double wanted = before - (whole ? here.least() : here.body);
    std::array<double, 2> elbows{}, hands{};
    for (std::size_t side = 0; side < 2 && !whole; ++side) {
      elbows[side] = before + limbs[2 + side].middle.y() - here.elbows[side];
      hands[side] = before + limbs[2 + side].end.y() - here.hands[side];
      wanted = std::max({wanted, elbows[side] - kArm, hands[side] - kArm});
      // A foot that stands does not rise with the figure. What its leg does not give is left to
      // ground_lift.h.
      const double most = kLeg * (1 - smooth_step(kBent, kStretched, here.stretched[side])),
                   foot = std::clamp(limbs[side].end.y() - here.feet[side], 0.0, most);
      limbs[side] = {0.5 * foot * Vec3::UnitY(), foot * Vec3::UnitY()};
    }
    const double lift = clearance.lift[f] = std::clamp(wanted, 0.0, kMost);
    for (std::size_t side = 0; side < 2 && !whole; ++side)
      limbs[2 + side] = {std::clamp(elbows[side] - lift, 0.0, kArm) * Vec3::UnitY(),
                         std::clamp(hands[side] - lift, 0.0, kArm) * Vec3::UnitY()};
  }
  smooth_maximum(std::max(1, int(std::lround(kRising * fps))), clearance.lift, std::greater<>());
  if (!whole) smooth_shifts(fps, clearance.shifts);
  return true;
}

bool open_hands(const Skeleton& skeleton, const GroundPoints& points,
                const std::vector<GroundHeights>& heights, Motion& motion) {
  bool any = false;
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t s = side == Side::left ? 0 : 1;
    const auto deep = [&](const GroundHeights& one) { return one.hands[s] < -kLeft; };
    if (std::ranges::none_of(heights, deep)) continue;
    any = true;
    HandOpener hand(skeleton, points, side);
    std::vector<double> share(heights.size(), 0.0);
    for (std::size_t f = 0; f < share.size(); ++f)
      if (deep(heights[f])) share[f] = hand.needed(motion.frames[f]);
    smooth_maximum(std::max(1, int(std::lround(kOpening * motion.fps))), share, std::greater<>());
    for (std::size_t f = 0; f < share.size(); ++f)
      if (share[f] > 0) hand.open(share[f], motion.frames[f]);
  }
  return any;
}

}  // namespace ecorche::inline v1
