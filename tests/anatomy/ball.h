// A unit ball as a closed mesh of 8 * 9^rounds triangles.
#pragma once

#include "anatomy/geometry/subdivide.h"

namespace ecorche::test {

inline TriMesh octahedron() {
  TriMesh mesh{Points(6, 3), Triangles(8, 3)};
  mesh.V << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
  mesh.F << 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5;
  return mesh;
}

inline TriMesh ball(int rounds) {
  const TriMesh base = octahedron();
  const Refinement fine = refine(base.F, 6, rounds);
  return {refine_points(fine, base.V).rowwise().normalized(), fine.F};
}

}  // namespace ecorche::test
