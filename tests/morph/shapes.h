// Shapes that several tests stand for limbs.
#pragma once

#include <cmath>
#include <numbers>

#include "anatomy/types.h"

namespace ecorche {

// A closed cylinder along y from y0 to y1, radius r, about the line (x, z) = (0, 0).
inline TriMesh cylinder(double r, double y0, double y1, int around = 96, int rings = 40) {
  TriMesh m{Points(around * rings + 2, 3), Triangles(2 * around * rings, 3)};
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < around; ++k) {
      const double turn = 2 * std::numbers::pi * k / around;
      m.V.row(i * around + k) << r * std::cos(turn), y0 + (y1 - y0) * i / (rings - 1),
          r * std::sin(turn);
    }
  const int low = around * rings, high = low + 1;
  m.V.row(low) << 0, y0, 0;
  m.V.row(high) << 0, y1, 0;
  int f = 0;
  for (int k = 0; k < around; ++k) {
    const int n = (k + 1) % around;
    for (int i = 0; i + 1 < rings; ++i) {
      const int a = i * around + k, b = i * around + n, c = a + around, d = b + around;
      m.F.row(f++) << a, c, d;
      m.F.row(f++) << a, d, b;
    }
    m.F.row(f++) << low, k, n;
    m.F.row(f++) << high, (rings - 1) * around + n, (rings - 1) * around + k;
  }
  return m;
}

}  // namespace ecorche
