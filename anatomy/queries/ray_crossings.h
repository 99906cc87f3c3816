// Rays that list every triangle they cross, in one pass through the hierarchy: who begins and ends
// where along a straight line.
//
// For many closed surfaces that lie in one another and change their shape but not their topology:
// the hierarchy is built once and then only fitted to the new points, and not at all for those that
// stay where they are.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "anatomy/types.h"

namespace ecorche {

struct Crossing {
  float distance = 0;  // along the unit direction, m
  int triangle = 0;
  bool entering = false;  // against the triangle's normal
};

// What a ray passes of one solid: once, from where it enters first to where it leaves last of what
// it entered then.
struct Stay {
  int solid = 0;
  double from = 0, to = 0;  // along the ray, m; from 0: it begins inside
  int depth = 0;            // how many of the solid's shells it is still in at its end
};

// `solids`: #F, which solid a triangle bounds. In the order of entering, those that it begins in as
// they are found out; what is not left ends at `far`.
void find_stays(std::span<const Crossing> crossings, std::span<const int> solids, double far,
                std::vector<Stay>& stays);

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

  // What the ray crosses up to `far`, m, nearest first, less the surfaces labelled `skip`; it ends
  // where it enters something beyond `enough`. Crossings of one surface in one sense within a
  // micrometre count once: they share an edge. The same list whatever the hierarchy. Precondition:
  // direction of length one.
  void cross(const Vec3& origin, const Vec3& direction, double far, double enough, int skip,
             std::vector<Crossing>& out) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche
