// How far the pelvis sinks or rises, and heels rise, so that planted legs fit over the ground.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// One leg in one frame.
struct LegReach {
  bool heel = false, ball = false;  // that stand
  // By how much the pelvis has to sink at least, m; raised: with the heel `most` rad up about the
  // ball. Below 0: it may rise.
  double flat = -HUGE_VAL, raised = -HUGE_VAL;
  double most = 0;
  double folded = 0;  // by how much the pelvis has to rise, since the hip bends no further, m
  double bent = 0;    // rad by which its heel has to rise, since its ankle bends no further
  Vec3 ankle = Vec3::Zero();  // from the hip, m, of a pelvis that does not sink
  double length = 0;          // of the leg, m
  double low = 0;  // by which the foot is lowered to stand, m; less of a leg that is bent
};

struct ReachPlan {
  std::vector<double> sunk;                 // of the pelvis, a frame, m
  std::array<std::vector<double>, 2> rise;  // of heels about balls, left and right, rad
};

// The pelvis rises, smoothly, where a leg folds no further. Beside that it sinks little and slowly,
// for what is sudden asks the ground for forces; it follows feet that hang over the ground in part,
// so that legs stay bent as they are. Heels whose ball stands rise where a leg is too short all the
// same, as those of people do, and where an ankle bends no further.
ReachPlan plan_reach(const std::array<std::vector<LegReach>, 2>& legs, double fps);

}  // namespace ecorche::inline v1
