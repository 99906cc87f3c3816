// Parts bones that lie in one another: a patella pressed into the femur by a thin knee's skin, a
// sacrum and hip bones of two sources. Of each pair both surfaces give way by half of what they
// share, and the bone about it follows, less with each ring of triangles.
#pragma once

#include <optional>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// Moves vertices (world, m) of `bones`, closed meshes turned outwards; others are left alone.
// `reference`: the same bones, vertex by vertex, in the body that they come from, or none: what
// they share there they may share here, so that bones parted once are not parted again.
// `even_about`: x of the plane of symmetry; bones of the right stay the images of those of the
// left, vertex by vertex. What bones share beyond some centimetre of depth stays. Deterministic at
// any thread count.
void part_bones(std::vector<Bone>& bones, const std::vector<Bone>& reference,
                std::optional<double> even_about);

}  // namespace ecorche::inline v1
