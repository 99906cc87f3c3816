// Muscles into another body: every path point, wrap and width direction goes where the bones that
// carry it go.
#pragma once

#include <functional>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// Where a rest point that rides on `joint` lies in the new body's rest pose, world to world. Need
// not be rigid; must be smooth over a few centimetres (directions are carried by differences over 5
// mm).
using CarryMap = std::function<Vec3(const Vec3& point, int joint)>;

// A point that is carried as `carrier` is: by the map of its joint, or the blend of both; one that
// glides by the map of the joint that places it.
Vec3 carry_point(const Vec3& point, const PathPoint& carrier, const CarryMap& map);

// Which ends of a strip lie on no bone and go with the flesh around them.
struct EndsInFlesh {
  bool origin = false, insertion = false;
};

// Path points by the map of their joint (as carry_point()); the reference and each
// slice's width direction by the map's local turn, wraps by its local turn and mean stretch;
// offsets by the local stretch. Slices keep s, radii and outline (see scale_radii); rest_length is
// measured anew. `inner`: where the flesh between goes, if that is not where the bones would carry
// it: via points, slices and their directions follow it, the reference and the wraps follow `map`,
// and so do the two ends, but for those that lie in the flesh.
Strip carry_strip(const Strip& strip, const CarryMap& map, const CarryMap& inner = {},
                  EndsInFlesh ends = {});

// All strips of all muscles. Muscle::volume is left as it is: whoever sets the radii knows what it
// should become.
std::vector<Muscle> carry_muscles(const std::vector<Muscle>& muscles, const CarryMap& map);

// Multiplies half widths by factors.x and half thicknesses by factors.y, and the offsets alike.
void scale_radii(Strip& strip, const Vec2& factors);

// Sum of the strips' tube volumes at rest, m^3.
double rest_volume(const Muscle& muscle);

// Scales all sections alike, so that they hold Muscle::volume, and sets it to what they hold. A
// muscle whose sections hold nothing stays as it is.
void widen_to_volume(Muscle& muscle);

}  // namespace ecorche::inline v1
