// The plane in which a girth, breadth or depth is measured, and what a tape does in a plane.
#pragma once

#include <utility>
#include <vector>

#include "anatomy/types.h"
#include "morph/measures/measure_table.h"

namespace ecorche::inline v1 {

// d(measure) = sum over entries of g . d(vertex). Vertices may occur more than once.
using MeasureGradient = std::vector<std::pair<int, Vec3>>;

struct MeasurePlane {
  Vec3 origin = Vec3::Zero(), normal = Vec3::UnitY();
  double length = 0;  // of the vector that was scaled to the normal; 0 where the normal is constant
};

// Through the measure's landmarks on the skin V.
MeasurePlane make_plane(const Measure& m, const Points& V);

// Adds the derivative by the landmarks: the chain rule from the derivatives by the plane's origin
// and normal.
void add_plane_gradient(const Measure& m, const Points& V, const MeasurePlane& plane,
                        const Vec3& by_origin, const Vec3& by_normal, MeasureGradient& out);

// Indices of the corners of the convex hull of points in a plane across `normal`, counter-clockwise
// about it.
std::vector<int> plane_hull(const std::vector<Vec3>& points, const Vec3& normal);

// Of a chain in a plane of constant x, the nodes that a string pulled over its outer side touches;
// both ends stay.
std::vector<int> bridged_chain(const std::vector<Vec3>& points);

}  // namespace ecorche::inline v1
