// The cut of a measure's plane with the skin; shared by the files that measure.
#pragma once

#include "morph/measures/tape_measure.h"

namespace ecorche {

struct TapeMeasure::Plane {
  Vec3 origin = Vec3::Zero(), normal = Vec3::UnitY();
  double length = 0;  // of the vector that was scaled to the normal; 0 where the normal is constant
};

// A point of a cut: (1 - t) a + t b on an edge.
struct TapeMeasure::Crossing {
  int a = 0, b = 0;
  double t = 0;
  Vec3 point = Vec3::Zero();
};

// Indices of the corners of the convex hull of points in a plane across `normal`, counter-clockwise
// about it.
std::vector<int> plane_hull(const std::vector<Vec3>& points, const Vec3& normal);

// Of a chain in a plane of constant x, the nodes that a string pulled over its outer side touches;
// both ends stay.
std::vector<int> bridged_chain(const std::vector<Vec3>& points);

}  // namespace ecorche
