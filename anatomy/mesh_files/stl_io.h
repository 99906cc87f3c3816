// STL in, and the components of a triangle soup.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// A binary or ASCII STL file: equal corners become one vertex, triangles that collapse are dropped.
// Units as in the file. Throws InputError that names `name`: truncated, more triangles than bytes,
// coordinates that are not finite.
TriMesh parse_stl(std::string_view bytes, const std::string& name);

// Whether the bytes are an STL file: as long as a binary one says, or text with facets.
bool is_stl(std::string_view bytes);

// The parts of a mesh that hang together across edges of exactly two triangles (so that doubled
// triangles fall off), largest (by triangles, then by first triangle) first. No repair is made.
std::vector<TriMesh> connected_components(const TriMesh& mesh);

// True when every edge has exactly two triangles that run along it in opposite directions.
bool is_closed(const TriMesh& mesh);

double surface_area(const TriMesh& mesh);

// Centroid of the surface; the mean of the vertices where the surface has no area.
Vec3 surface_centroid(const TriMesh& mesh);

}  // namespace ecorche::inline v1
