// A ray against eight boxes at once. Private to the room.
#pragma once

#include <cmath>

#include "anatomy/compute/simd_lanes.h"

namespace ecorche::inline v1 {

struct Ray {
  Wide3 origin, direction, inverse;  // the same in every lane
  float near = 0;
  float own = -1;  // >= 0: backs alone are seen, and nothing at about this distance
};

inline Ray make_ray(Float4 from, Float4 direction, float near) {
  const auto inverse = [&](int k) {
    return all_eight(
        1 / (std::abs(direction[k]) > 1e-12f ? direction[k] : std::copysign(1e-12f, direction[k])));
  };
  const auto same = [](Float4 v) {
    return Wide3{all_eight(v[0]), all_eight(v[1]), all_eight(v[2])};
  };
  return {same(from), same(direction), {inverse(0), inverse(1), inverse(2)}, near};
}

// Where the ray enters eight boxes, and which of them it does; `box`: low x of the eight, low y,
// low z, high x, high y, high z.
inline Float8 entries(const float* box, const Ray& ray, float far, unsigned& enters) {
  const Float8 ax = (load8(box) - ray.origin.x) * ray.inverse.x,
               bx = (load8(box + 24) - ray.origin.x) * ray.inverse.x;
  const Float8 ay = (load8(box + 8) - ray.origin.y) * ray.inverse.y,
               by = (load8(box + 32) - ray.origin.y) * ray.inverse.y;
  const Float8 az = (load8(box + 16) - ray.origin.z) * ray.inverse.z,
               bz = (load8(box + 40) - ray.origin.z) * ray.inverse.z;
  const Float8 in =
      most(most(least(ax, bx), least(ay, by)), most(least(az, bz), all_eight(ray.near)));
  const Float8 out = least(least(most(ax, bx), most(ay, by)), least(most(az, bz), all_eight(far)));
  enters = lanes_that(in <= out);
  return in;
}

}  // namespace ecorche::inline v1
