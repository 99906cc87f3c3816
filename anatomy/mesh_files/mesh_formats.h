// The readers behind mesh_io.h, one a format.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "anatomy/limits.h"
#include "anatomy/mesh_files/mesh_io.h"

namespace ecorche {

void parse_obj(std::string_view text, const std::string& name, MeshFile& out);
void parse_ply(std::string_view bytes, const std::string& name, MeshFile& out);
void parse_glb(std::string_view bytes, const std::string& name, MeshFile& out);

// Polygons on points, gathered corner by corner and cut into triangles at the end.
struct Polygons {
  std::vector<double> coordinates;  // xyz of each vertex
  std::vector<int> corners;         // 0-based vertices of all polygons, one after the other
  std::vector<int> sizes;           // corners of each polygon
};

// Quads along the diagonal inside them, larger polygons by clipping ears. Corners that repeat their
// neighbour are dropped, polygons left with fewer than three are passed over and counted. Throws
// UnfitError when nothing is left. Precondition: every corner is a vertex.
TriMesh triangulate(const Polygons& polygons, const std::string& name,
                    std::vector<std::string>& notes);

}  // namespace ecorche
