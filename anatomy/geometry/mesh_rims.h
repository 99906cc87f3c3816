// Open boundaries of parts of a triangle mesh.
#pragma once

#include <array>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// A loop of directed edges, wound as the missing faces would be.
using MeshRim = std::vector<std::array<int, 2>>;

// The directed boundary of a set of triangles, reversed and chained into loops.
std::vector<MeshRim> open_rims(const std::vector<int>& triangles, const Triangles& F);

}  // namespace ecorche::inline v1
