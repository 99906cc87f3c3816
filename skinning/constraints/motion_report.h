// What the stages that correct a motion found and changed.
#pragma once

#include <string>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// A span in which a point of a foot stands.
struct Contact {
  Side side = Side::left;
  bool heel = false;       // else the ball of the foot
  int begin = 0, end = 0;  // frames [begin, end)
  double slide = 0;        // largest horizontal distance of the planted point from its position, m
  // Parts of a frame by which it begins before its first one and lasts beyond its last one.
  double early = 0, late = 0;
};

// A span in which neither foot touches the ground.
struct Flight {
  int begin = 0, end = 0;     // frames [begin, end)
  double gravity_before = 0;  // of the scaled source, m/s^2
};

// A joint beyond its limits.
struct LimitBreak {
  std::string joint;
  int frames = 0;  // number of frames outside
  int worst_frame = 0;
  double worst = 0;  // rad beyond the limit
};

// Self-collision of one kind: limbs inside one another, the trunk or the head.
struct Penetration {
  std::string what;  // "leg and leg", ...; see kCollisionNames
  int frames = 0;
  double worst = 0;  // m beyond the tolerated depth
  int worst_frame = 0;
  double left = 0;  // m, after the correction
};

// Displacement of a limb's end by enforcing the joint limits, over all frames, m. Against its
// position in the file; a standing foot's ball also against the position where it was planted.
struct EndMove {
  std::string end;  // "head", "wrist_l", "subtalar_l", ...
  double mean = 0, most = 0;
  int worst_frame = 0;
};

}  // namespace ecorche::inline v1
