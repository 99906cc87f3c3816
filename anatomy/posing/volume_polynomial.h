// Volume of a strip as a function of the scale of its belly: exactly a cubic. Of one strip (T =
// double) or of several at once. Private to posing.
//
// A section's axes are scaled by 1 + belly x, x the belly's scale less 1: the thickness, and the
// width where `width_swells` is 1, not 0. Each term of tube_volume is a product of two or three
// axes and of constants.
#pragma once

#include "anatomy/compute/vector3.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {

template <class T>
struct ScaledSection {
  Vec3xN<T> center, a, b;  // m; width and thickness axis, each times its radius
  T belly;
};

// In units of pi / 3 m^3.
template <class T>
struct VolumePolynomial {
  T q0, q1, q2, q3;

  T operator()(const T& x) const { return q0 + x * (q1 + x * (q2 + x * q3)); }
  T slope(const T& x) const { return q1 + x * (2 * q2 + 3 * x * q3); }

  // Adds the piece between two sections. `areas` of the two, `own_second` that of the second alone.
  void add(const ScaledSection<T>& first, const ScaledSection<T>& second, const AreasOf<T>& areas,
           const T& own_second, const T& width_swells) {
    const auto& [c0, a0, b0, g0] = first;
    const auto& [c1, a1, b1, g1] = second;
    const T& w = width_swells;
    const Vec3xN<T> d = c1 - c0, n0 = cross(a0, b0), n1 = cross(a1, b1), across_a = cross(d, a0),
                    across_b = cross(d, b0);
    const T s0 = areas.own * dot(d, n0), s1 = own_second * dot(d, n1);
    const T p = 0.5 * areas.ab * dot(across_a, b1), q = -0.5 * areas.ba * dot(across_b, a1);
    const T u = 0.5 * areas.aa * dot(across_a, a1), v = 0.5 * areas.bb * dot(across_b, b1);
    q0 += s0 + p + q + u + v + s1;
    q1 += (w + 1) * (s0 * g0 + s1 * g1) + p * (w * g0 + g1) + q * (w * g1 + g0) +
          (w * u + v) * (g0 + g1);
    q2 += w * (s0 * g0 * g0 + (p + q + u) * g0 * g1 + s1 * g1 * g1) + v * g0 * g1;
    add_lopsided(areas.more_a1 * dot(n0, a1), w * g1, w * g0, g0);
    add_lopsided(areas.more_b1 * dot(n0, b1), g1, w * g0, g0);
    add_lopsided(-areas.more_a0 * dot(n1, a0), w * g0, w * g1, g1);
    add_lopsided(-areas.more_b0 * dot(n1, b0), g0, w * g1, g1);
  }

 private:
  // Adds a product of three axes that are scaled by 1 + f x, 1 + g x and 1 + h x.
  void add_lopsided(const T& product, const T& f, const T& g, const T& h) {
    q0 += product;
    q1 += product * (f + g + h);
    q2 += product * (f * g + f * h + g * h);
    q3 += product * f * g * h;
  }
};

}  // namespace ecorche::inline v1
