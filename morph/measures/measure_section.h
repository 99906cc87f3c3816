// Girths, breadths and depths: the loop of a plane's cut with the skin, its length or its hull's,
// and its derivative.
#pragma once

#include <array>
#include <vector>

#include "anatomy/types.h"
#include "morph/measures/measure_plane.h"

namespace ecorche::inline v1 {

// Where the tape lies, to be drawn: polylines, world.
using TapeTrace = std::vector<std::vector<Vec3>>;

// What of the skin does not change with its shape.
struct SectionMesh {
  Triangles triangles;
  // across edge e (corner e to e + 1) of each triangle; -1 at a border
  std::vector<std::array<int, 3>> neighbours;
  std::vector<bool> arm;  // #skin: on arm or hand
};

SectionMesh make_section_mesh(const Triangles& triangles);  // `arm` stays empty

// A point of a cut: (1 - t) a + t b on an edge.
struct SkinCrossing {
  int a = 0, b = 0;
  double t = 0;
  Vec3 point = Vec3::Zero();
};

// The loop of the cut through that of the triangles `starts` which has the corner nearest to
// `near`; empty where the plane cuts none of them.
void cut_loop(const SectionMesh& mesh, const std::vector<int>& starts, const Points& V,
              const Vec3& origin, const Vec3& normal, const Vec3& near,
              std::vector<SkinCrossing>& loop);

// A girth, breadth or depth, m; NaN where the plane misses the skin. `starts`: triangles on which
// the loop may be found. Adds to `gradient` and `trace` when given.
double take_section(const SectionMesh& mesh, const Measure& m, const std::vector<int>& starts,
                    const Points& V, MeasureGradient* gradient, TapeTrace* trace);

}  // namespace ecorche::inline v1
