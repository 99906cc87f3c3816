// Normals, areas and borders of clouds, which have nothing but points.
#pragma once

#include <optional>
#include <vector>

#include "anatomy/types.h"
#include "morph/registration/cloud_neighbours.h"

namespace ecorche::inline v1 {

// Normals by the principal axes of each point's neighbours; their sides are not told. #N x 3
Points plane_normals(const Points& points, const CloudNeighbours& near);

// The surface that each point stands for, m^2, from the density of its neighbours.
std::vector<float> cloud_areas(const CloudNeighbours& near);

// 1: within its tangent plane a point has no neighbours over more than 120 degrees.
std::vector<char> cloud_borders(const Points& points, const Points& normals,
                                const CloudNeighbours& near);

// Where a depth camera stood that gave all points, when that is the origin: each direction from
// there meets one depth. Nothing: it is not.
std::optional<Vec3> depth_camera(const Points& points);

// Turns normals outwards: to the camera where one is told; otherwise to those of 26 directions that
// a point is seen from; what none or opposite ones see follows its neighbours along a spanning tree
// (Hoppe et al. 1992), and a surface that is seen from both sides bulges outwards.
void orient_normals(const Points& points, const CloudNeighbours& near,
                    const std::optional<Vec3>& camera, Points& normals);

}  // namespace ecorche::inline v1
