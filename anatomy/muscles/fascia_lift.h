// Keeps sheets of fascia over the muscles that they cover: as a joint bends, bellies slide along
// below a sheet and come out where it is carried by something else, as the vasti at a bent knee.
//
// A sheet covers the strips that lie right below some of it at rest. Where one comes to lie over a
// point by more than it does at rest (edges are tucked in), the point rises along the sheet's
// normal to its outline, and what is about it with it, as a membrane: heights h >= need, each
// elsewhere the mean of its neighbours.
#pragma once

#include <span>
#include <vector>

#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/posed_anatomy.h"

namespace ecorche::inline v1 {

struct FasciaLift {
  struct Cover {
    int begin = 0, end = 0;  // sections of a strip that may come over the point
    float rest = 0;          // m, its height over the point at rest
  };
  std::vector<int> begin{0};  // #V + 1, of points' covers
  std::vector<Cover> covers;
};

// How far a point must move along the unit direction `out` until it lies outside the strip that
// runs through the sections, m; 0 where it does, at most kMostFasciaLift.
constexpr float kMostFasciaLift = 0.025f;
// m from a section, at which its strip may come over a point.
constexpr double kFasciaLiftReach = 0.05;
float height_over_strip(std::span<const Ellipse> sections, const Vec3& point, const Vec3& out);

// Adds the points of one sheet at rest, the rows [begin, end) of `points` and `normals`. Without
// `rises` they have no covers. Precondition: the slices are those of `strips`.
void add_covers(std::span<const SliceRange> strips, std::span<const Ellipse> slices,
                const PointsF& points, const PointsF& normals, int begin, int end, bool rises,
                FasciaLift& lift);

// What a point's covers ask for, m; 0: nothing.
float wanted_lift(const FasciaLift& lift, const PosedAnatomy& posed, int point, const Vec3& at,
                  const Vec3& out);

// Heights of a grid of points that asks for `heights`, spread to their neighbours.
void spread_lift(int rows, int columns, std::span<float> heights, std::span<float> workspace);

}  // namespace ecorche::inline v1
