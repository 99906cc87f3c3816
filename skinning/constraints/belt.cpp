#include "skinning/constraints/belt.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ecorche::inline v1 {
namespace {

constexpr double kSlowest = 0.6;  // m/s
constexpr double kSteady = 0.2;   // of its speed: median distance of what stands on it
constexpr double kLow = 0.03;     // m over the floor
constexpr std::size_t kLeastPoints = 10;

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Vec3 belt_velocity(std::span<const Vec3> low_points) {
  std::vector<double> x, z, off;
  for (const Vec3& v : low_points)
    if (std::abs(v.y()) < 0.5 * kSlowest) x.push_back(v.x()), z.push_back(v.z());
  if (x.size() < kLeastPoints) return Vec3::Zero();
  const Vec3 belt(median_of(x), 0, median_of(z));
  for (std::size_t i = 0; i < x.size(); ++i)
    off.push_back(std::hypot(x[i] - belt.x(), z[i] - belt.z()));
  return belt.norm() > kSlowest && median_of(off) < kSteady * belt.norm() ? belt
                                                                          : Vec3(Vec3::Zero());
}

Vec3 belt_velocity(const std::array<FootPaths, 2>& feet, const Motion& motion) {
  const std::vector<double> floor = floor_heights(feet, motion);
  std::vector<Vec3> low;
  for (const FootPaths& foot : feet)
    for (const std::vector<Vec3>* path : {&foot.heel, &foot.ball})
      for (std::size_t f = 1; f + 1 < path->size(); ++f)
        if ((*path)[f].y() - floor[f] < kLow)
          low.push_back(0.5 * motion.fps * ((*path)[f + 1] - (*path)[f - 1]));
  return belt_velocity(low);
}

void move_by_belt(const Vec3& belt, Motion& motion) {
  for (std::size_t f = 0; f < motion.frames.size(); ++f)
    motion.frames[f].root -= double(f) / motion.fps * belt;
}

void move_by_belt(const Vec3& belt, std::array<FootPaths, 2>& feet, Motion& motion) {
  move_by_belt(belt, motion);
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    const Vec3 way = -double(f) / motion.fps * belt;
    for (FootPaths& foot : feet) {
      foot.heel[f] += way;
      foot.ball[f] += way;
    }
  }
}

}  // namespace ecorche::inline v1
