// Filters of motions, and their application in the order in which they are given.
//
// They work between the joint limits and the planting of feet (retarget/retarget.h), so that what
// they leave is planted and within the limits. A new filter is a struct here, a pair of files, and
// a line in motion_filters.cpp and in app/options/filter_options.cpp.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "skinning/filters/blend_motions.h"
#include "skinning/filters/filtered_motion.h"
#include "skinning/filters/loop_motion.h"

namespace ecorche::inline v1 {

struct LockFeet {
  double strength = 1;
};
struct SmoothFrames {
  double width = 0.1;  // s
};
struct WarpTime {
  double speed = 1;
};
struct FitLength {
  double length = 1;  // s
};
struct ChangeRate {
  double fps = 30;
};
struct MirrorMotion {};
struct StraightenPath {};
struct BendPath {
  double angle = 0;  // rad, to the left
};
struct FollowPoints {
  std::vector<Eigen::Vector2d> points;  // x, z in m
};
struct TurnMotion {
  double angle = 0;  // rad, to the left
};
struct SlopeGround {
  double angle = 0;  // rad, up
};
struct GoOver {
  FilteredMotion second;
  Transition transition;
};
struct MixWith {
  FilteredMotion second;
  double share = 0.5;
};

using MotionFilter =
    std::variant<LockFeet, SmoothFrames, WarpTime, FitLength, ChangeRate, MirrorMotion, LoopOptions,
                 StraightenPath, BendPath, FollowPoints, TurnMotion, SlopeGround, GoOver, MixWith>;

// Whether a filter moves feet that stand, which are then to be planted anew.
bool moves_feet(const std::vector<MotionFilter>& filters);

// Applies all in turn. `name`: of the motion's file, for messages. Throws as the filters.
void apply_filters(const std::string& name, const Skeleton& skeleton,
                   const std::vector<MotionFilter>& filters, FilteredMotion& filtered);

}  // namespace ecorche::inline v1
