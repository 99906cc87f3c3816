// Rays that list every triangle they cross, in one pass through the hierarchy, and the intervals of
// a ray inside each solid.
//
// For many nested or overlapping closed surfaces that change their shape but not their topology:
// the hierarchy is built once and then refitted to the points that have moved.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct Crossing {
  float distance = 0;  // along the unit direction, m
  int triangle = 0;
  bool entering = false;  // against the triangle's normal
};

// Interval of a ray inside a solid: from where it first enters to where it has left all shells that
// it entered since.
struct RayInterval {
  int solid = 0;
  double from = 0, to = 0;  // along the ray, m; from 0: it begins inside
  int depth = 0;            // number of the solid's shells that it is still inside at its end
};

// `solids`: #F, the solid that each triangle bounds. In the order of entering; a solid that the ray
// begins in is inserted where the ray leaves it. Intervals without an exit end at `far`.
void find_intervals(std::span<const Crossing> crossings, std::span<const int> solids, double far,
                    std::vector<RayInterval>& intervals);

// Queries are const and may run in several threads.
class CrossingRays {
 public:
  // `labels`: #F, whose surface a triangle is. `moving`: so many of the points, the first, may be
  // moved later. Throws std::invalid_argument for an empty mesh, indices out of range, coordinates
  // that are not finite, labels that do not match, or where triangles of moving points, and of them
  // alone, are not the first, or there are none.
  CrossingRays(const Points& V, const Triangles& F, std::vector<int> labels, Eigen::Index moving);
  ~CrossingRays();
  CrossingRays(const CrossingRays&) = delete;
  CrossingRays& operator=(const CrossingRays&) = delete;

  // The moving points elsewhere. Precondition: as many finite ones. No query may run meanwhile.
  void move(const Points& V);

  // Crossings up to `far`, m, nearest first, without surfaces labelled `skip`; the list ends where
  // the ray enters a surface beyond `enough`. Crossings of one surface in one sense within a
  // micrometre count once: they share an edge. The same list whatever the hierarchy. Precondition:
  // direction of length one.
  void cross(const Vec3& origin, const Vec3& direction, double far, double enough, int skip,
             std::vector<Crossing>& out) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche::inline v1
