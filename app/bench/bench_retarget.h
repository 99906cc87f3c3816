// Time of retargeting a motion file, for `ecorche bench`.
#pragma once

#include <filesystem>

#include "anatomy/character.h"

namespace ecorche {

struct RetargetPace {
  double frames_per_second = 0;  // of the file, by one thread's CPU time
  double ratio = 0;              // of that time and the forward kinematics of the poses alone
};

// The least times of `rounds` rounds, with limits, planted feet and limbs kept apart. Throws as
// read_motion() and retarget().
RetargetPace bench_retarget(const std::filesystem::path& file, const Character& character,
                            int rounds);

}  // namespace ecorche
