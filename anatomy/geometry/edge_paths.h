// Distances along the edges of a mesh, and the line through the middle of what lies between two of
// its points.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// A mesh whose equal vertices are one: files often cut surfaces open along seams.
TriMesh welded(const TriMesh& mesh);

// Length of the shortest way along edges from a vertex to every other; infinite where there is
// none. #V
std::vector<double> edge_distances(const TriMesh& mesh, int from);

int nearest_vertex(const TriMesh& mesh, const Vec3& point);

// Middles of `count` bands of surface between the two points, in order from a to b: bands of equal
// relative distance from the two along the surface, so that they follow a bent part. Bands without
// surface are left out.
std::vector<Vec3> middle_line(const TriMesh& mesh, const Vec3& a, const Vec3& b, int count);

}  // namespace ecorche::inline v1
