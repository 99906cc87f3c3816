// Fewer triangles over the vertices that a mesh has, for pictures that are drawn while a hand
// moves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "viewer/draw_list.h"

namespace ecorche {

// By vertex the one that stands for it: one of the same stretch of surface, reached over edges
// without going further than `reach`, m, or turning by more than 78 degrees, so that the two sides
// of a sheet stay two. A vertex that stands for others stands for itself. Arrays as in DrawMesh.
std::vector<std::uint32_t> standing_for(std::span<const Vec3f> positions,
                                        std::span<const Vec3f> normals,
                                        std::span<const Triangle32> triangles, float reach);

// The triangles between vertices that stand for others.
std::vector<Triangle32> coarse_triangles(std::span<const Triangle32> triangles,
                                         std::span<const std::uint32_t> standing);

}  // namespace ecorche
