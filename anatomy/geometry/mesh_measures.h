// Plain figures of triangle meshes.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// By the divergence theorem; positive for closed meshes with outward normals, m^3.
double mesh_volume(const TriMesh& mesh);

double mesh_area(const TriMesh& mesh);  // m^2

// Area-weighted unit normals, #V x 3; zero for vertices of no triangle.
Points vertex_normals(const TriMesh& mesh);

// Area at each vertex, a third of its triangles', m^2.
std::vector<double> vertex_areas(const TriMesh& mesh);

// From a point to the nearest triangle, m; infinite for a mesh without triangles.
double distance_to_mesh(const Vec3& p, const TriMesh& mesh);

// Whether every edge has exactly two triangles, which run along it in opposite directions.
bool is_closed(const Triangles& F);

}  // namespace ecorche::inline v1
