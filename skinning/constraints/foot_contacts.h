// Foot contacts: when and where feet stand.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// A foot as a rigid sole from heel to ball and a toe part, in the rest pose's world coordinates.
struct FootShape {
  int hip = -1, knee = -1, ankle = -1, subtalar = -1;
  std::array<int, 5> mtp{};
  Vec3 heel = Vec3::Zero(), ball = Vec3::Zero(),
       tip = Vec3::Zero();      // on the ground under the standing foot
  Vec3 toes_up = Vec3::Zero();  // the tip at full extension of the toes
};

// sole_height: world y of the soles at rest. Precondition: the skeleton has our joints.
FootShape foot_shape(const Skeleton& skeleton, Side side, double sole_height);

// A guess from the toe joints, for a skeleton without its skin.
double guess_sole_height(const Skeleton& skeleton);

// The joints that carry the points of both feet, and all above them (joints_up_from()).
std::vector<int> feet_joints(const Skeleton& skeleton);

// The points of a posed foot.
struct FootPoints {
  Vec3 heel, ball, tip;
};
FootPoints foot_points(const Skeleton& skeleton, const FootShape& foot,
                       const std::vector<Transform>& X_WJ);

// Positions of heel and ball of one foot on the file's own legs, by frame. Contacts are detected on
// these, since there the feet really stood.
struct FootPaths {
  std::vector<Vec3> heel, ball;
};

// Height of the floor under the feet, a frame: that of most of the motion, except where the lower
// foot is still for 0.1 s somewhere else with the hips well over it (on a step, or in a capture
// whose floor drifts).
std::vector<double> floor_heights(const std::array<FootPaths, 2>& paths, const Motion& motion);

// A span of time and the frames in it: it begins between two frames and ends between two.
struct Interval {
  int begin = 0, end = 0;      // frames [begin, end)
  double early = 0, late = 0;  // parts of a frame before the first one, beyond the last one
  double onset() const { return begin - early; }
  double lift() const { return end - 1 + late; }
};

// Spans in which a point stands: lower than 40 mm over the floor and slower than 0.6 m/s
// throughout, somewhere lower than 25 mm and slower than 0.35 m/s, at least 60 ms long; gaps
// shorter than 60 ms at one position are closed. A point that goes on by more than 30 mm between
// two places in which it stays for 0.12 s stands in both and not between. The path is seen as a
// smooth curve near its frames, a mean over 0.03 s to either side, and speeds over one time, so
// that spans hardly depend on the rate or on a recording's tremble. `beside`: spans in
// which another point of that foot stands. Where they overlap by 60 ms this one stands, too, though
// it comes nowhere so low and slow.
std::vector<Interval> standing_intervals(const std::vector<Vec3>& path,
                                         const std::vector<double>& floor, double fps,
                                         std::span<const Interval> beside = {});

}  // namespace ecorche::inline v1
