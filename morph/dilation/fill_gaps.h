// Gaps under the fat layer: where no muscle lies against it, and which sections have to grow to
// fill them.
#pragma once

#include <span>
#include <vector>

#include "anatomy/queries/ray_crossings.h"
#include "morph/dilation/packed_sections.h"
#include "morph/fat/fat_layer.h"

namespace ecorche::inline v1 {

// The layer's underside: one point a vertex of the skin, and the skin's unit normal there.
struct Underside {
  Points points, normals;
};
Underside underside(const TriMesh& skin, const FatLayer& fat);

// Where the surface of a muscle has to come up.
struct Raise {
  int triangle = -1;              // of the drawn surface; -1: nowhere
  float by = 0;                   // m
  Vec3 direction = Vec3::Zero();  // against which it comes up, unit
};

// The radial directions of the sections that the triangles' corners follow have to grow, in
// proportion to their inclination, and those next to them by a part of it: for each slice and
// direction by how much, m. `F`: of the raises' triangles.
std::vector<float> asked_of_sections(const PackedSections& sections, const MuscleSurface& surface,
                                     const Triangles& F, std::span<const Raise> raises);

// From each point of the underside a ray goes straight in. The muscle that it meets first has to
// grow up to it. Returns, for each slice and direction, by how much it has to grow, m. `around`:
// where nothing lies within a centimetre straight in, six rays inclined by 58 degrees look for what
// lies beside it. `flesh`: rays against `F`, #F triangles of which the first are the surface's own;
// `solids`: #F, muscles, negative for bones.
std::vector<float> find_gaps(const PackedSections& sections, const MuscleSurface& surface,
                             const Underside& underside, const CrossingRays& flesh,
                             const Triangles& F, std::span<const int> solids, bool around);

}  // namespace ecorche::inline v1
