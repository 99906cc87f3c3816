// Which joints move the sections of a strip in the map of a body's inside, by what its line passes.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/interior/map_weights.h"

namespace ecorche::inline v1 {

// How far the bones of a strip's ends hold each of its sections: wholly at an end, fading along the
// strip. Ends in fascia are held by none. A deep strip whose line lies along the bone of an end for
// most of its length is bedded on that bone. `slices`: the strip's, at rest.
std::vector<BoneHold> bone_holds(const Muscle& muscle, const Strip& strip,
                                 std::span<const Ellipse> slices);

// How far the carriers of a line's gliding points (PathPoint::placing_joint) move its sections in
// place of the bone below them: wholly at such a point, not at all at the next point that does not
// glide.
std::vector<GlideHold> glide_holds(const Strip& strip, std::span<const Ellipse> slices);

// Joints that move each section as its own, #sections x #joints, 0 .. 1: those that the line passes
// from the point before the section to the point after it, fading beyond. A belly on a shin goes
// with the shin, though its tendon comes from the thigh. A sheet's are those of its whole line, so
// that it stays with the sheets beside it. `parents`: of the joints, before their children.
std::vector<std::vector<double>> own_joints(const Strip& strip, bool sheet,
                                            std::span<const int> parents,
                                            std::span<const Ellipse> slices);

}  // namespace ecorche::inline v1
