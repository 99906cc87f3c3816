// Generated strips and limbs for the tests of muscle lines, posing and surfaces.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/muscle_line.h"

namespace ecorche::testing {

inline PathPoint on(int joint, const Vec3& p) {
  PathPoint point;
  point.rest = p;
  point.joints[0] = joint;
  return point;
}

// Sections of a spindle: tendon of radius `tendon` outside the belly, widest in its middle.
inline std::vector<Station> spindle(int count, double radius, double tendon, double begin, double end, const Vec3& width) {
  std::vector<Station> stations;
  for (int k = 0; k < count; ++k) {
    Station station;
    station.s = static_cast<double>(k) / (count - 1);
    const double u = (station.s - begin) / (end - begin);
    const double bulge = u > 0 && u < 1 ? std::sin(std::numbers::pi * u) : 0;
    station.radii = Vec2(tendon + (radius - tendon) * bulge, 0.7 * (tendon + (radius - tendon) * bulge));
    station.width = width;
    stations.push_back(station);
  }
  return stations;
}

// A bent, twisting path with uneven pieces.
inline std::vector<PathPoint> bent_path() {
  return {on(0, {0.02, 1.30, 0.01}), on(0, {0.03, 1.22, 0.03}), on(1, {0.05, 1.02, 0.035}), on(1, {0.045, 0.99, 0.03}), on(2, {0.03, 0.90, -0.01})};
}

}  // namespace ecorche::testing
