#include "skinning/retarget/refine_frames.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "skinning/motion/sample_motion.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kWorked = 120;  // frames a second

}  // namespace

void refine_frames(Motion& motion, std::array<FootPaths, 2>& feet,
                   std::vector<LimbShifts>& shifts) {
  const int times = std::max(1, int(std::lround(kWorked / motion.fps)));
  if (times == 1 || motion.frames.size() < 2) return;
  const Motion given = std::move(motion);
  const std::array<FootPaths, 2> given_feet = std::move(feet);
  const std::vector<LimbShifts> given_shifts = std::move(shifts);
  const std::size_t count = (given.frames.size() - 1) * std::size_t(times) + 1;
  motion = {given.fps * times, std::vector<Pose>(count)};
  feet = {};
  shifts.clear();
  for (std::size_t f = 0; f < count; ++f) {
    const double at = double(f) / times;
    pose_at_frame(given, at, motion.frames[f]);
    for (std::size_t side = 0; side < 2; ++side) {
      feet[side].heel.push_back(place_at_frame(given_feet[side].heel, at));
      feet[side].ball.push_back(place_at_frame(given_feet[side].ball, at));
    }
    if (given_shifts.empty()) continue;
    const std::size_t before = f / std::size_t(times),
                      after = std::min(before + 1, given_shifts.size() - 1);
    const double share = at - double(before);
    LimbShifts& here = shifts.emplace_back();
    for (std::size_t l = 0; l < here.size(); ++l) {
      const LimbShift &a = given_shifts[before][l], &b = given_shifts[after][l];
      here[l] = {(1 - share) * a.middle + share * b.middle, (1 - share) * a.end + share * b.end};
    }
  }
}

}  // namespace ecorche::inline v1
