// Polygons into triangles.
#pragma once

#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Polygons on points, gathered corner by corner and cut into triangles at the end.
struct Polygons {
  std::vector<double> coordinates;  // xyz of each vertex
  std::vector<int> corners;         // 0-based vertices of all polygons, one after the other
  std::vector<int> sizes;           // corners of each polygon
};

// Where the triangles come from.
struct TriangleSources {
  std::vector<int> corners;   // 3 #F: places in Polygons::corners
  std::vector<int> polygons;  // #F
};

// Quads along the diagonal inside them, larger polygons by clipping ears. Corners that repeat their
// neighbour are dropped, polygons left with fewer than three are passed over and counted. Throws
// UnfitError when nothing is left, unless there was no polygon and `clouds` allows that.
// Precondition: every corner is a vertex.
TriMesh triangulate(const Polygons& polygons, const std::string& name,
                    std::vector<std::string>& notes, bool clouds = false,
                    TriangleSources* sources = nullptr);

}  // namespace ecorche::inline v1
