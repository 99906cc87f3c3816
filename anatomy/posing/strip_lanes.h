// The same quantity of four strips side by side (SIMD). Private to posing.
//
// Strips of equal slice count are posed four at a time, one a lane: the frames along a strip depend
// on one another, so the arithmetic runs in parallel across strips.
#pragma once

#include <Eigen/Core>

#include "anatomy/compute/vector3.h"

namespace ecorche::inline v1 {

constexpr int kLanes = 4;
// The same quantity of four strips; or x, y, z, 1 of one point.
using Double4 = Eigen::Array<double, kLanes, 1>;
using Vec3x4 = Vec3xN<Double4>;

inline Vec3x4 unit(const Vec3x4& a) { return dot(a, a).max(1e-300).rsqrt() * a; }

}  // namespace ecorche::inline v1
