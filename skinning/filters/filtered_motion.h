// A motion on our skeleton as filters find and leave it: within its joints' limits, its feet not
// yet planted, with all that planting and flights need to know.
#pragma once

#include <optional>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/motion_report.h"
#include "skinning/motion/ground_move.h"

namespace ecorche::inline v1 {

// A motion of three rounds, the middle one of which is kept when its feet are planted: so planting
// sees what comes before and after.
struct LoopRounds {
  int frames = 0;           // of one round
  GroundMove round;         // from a frame to the same one of the next round
  bool keep_travel = true;  // else the round's way is taken out
};

struct FilteredMotion {
  Motion motion;
  std::vector<Contact> contacts{};  // spans in which feet are to stand
  Vec3 belt = Vec3::Zero();         // m/s: of the treadmill from which the motion was taken
  double gravity = 9.81;            // m/s^2, in flight: a jump in slow motion falls slowly
  double lock = 1;                  // strength of planting, 0 to 1
  double slope = 0;                 // rad: what the ground rises by along the way
  std::optional<LoopRounds> loop{};
};

}  // namespace ecorche::inline v1
