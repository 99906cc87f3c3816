// Edges of drawn muscles: where the surface turns, and which points stand off their neighbours.
#pragma once

#include <span>
#include <vector>

#include "anatomy/muscles/muscle_surface.h"

namespace ecorche::inline v1 {

// An inner edge of a muscle's surface: its ends, and the faces on its sides.
struct SurfaceEdge {
  int muscle = 0;
  int begin = 0, end = 0;
  int left = 0, right = 0;
  double length = 0, turn = 0;  // m; rad, between the faces' normals
};

// Where the surface's vertices are; `positions` may hold more points after them. Ascending by
// muscle.
std::vector<SurfaceEdge> inner_edges(const MuscleSurface& surface, const Points& positions);

// How long an edge is and how much the surface turns there, elsewhere.
SurfaceEdge edge_at(const SurfaceEdge& edge, const MuscleSurface& surface, const Points& positions);

// How far each vertex stands off the mean of its neighbours, m: all the way, and along the
// surface's normal there: positive where it stands out of the surface, negative where it lies in
// it.
struct Standing {
  std::vector<double> off, out;  // #V
};

Standing standing_off(const MuscleSurface& surface, std::span<const SurfaceEdge> edges,
                      const Points& positions);

}  // namespace ecorche::inline v1
