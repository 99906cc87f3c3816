// One slice and the room around it: an ellipse among half planes.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/fat/fat_layer.h"

namespace ecorche::inline v1 {

// normal . p <= bound for the points p of the slice's plane, in (width, thickness) coordinates
// about the slice's centre, m.
struct HalfPlane {
  Vec2 normal = Vec2::UnitX();
  double bound = 0;  // to the layer
  double give = 0;   // how far a section may press into the layer: half of it
  double layer = 0;  // from the bound to the skin
};

// An ellipse along the axes of its slice, relative to the slice's first centre.
struct SliceSection {
  Vec2 center = Vec2::Zero();
  Vec2 radii = Vec2::Zero();

  double support(const Vec2& n) const { return n.dot(center) + radii.cwiseProduct(n).norm(); }
};

struct RoomCount {
  long long rays = 0, misses = 0;
  bool outside = false;  // the centre lies outside the skin
};

// Unit vectors evenly round a slice, from its width axis on.
std::vector<Vec2> ray_directions(int count);

// Casts a ray in each direction of the slice's plane and turns their ends into half planes. Where
// the centre lies outside the skin, it is moved inside first: `slice.center` changes.
RoomCount find_room(Ellipse& slice, std::span<const Vec2> directions, const SkinRays& rays,
                    const FatLayer& fat, double clearance, std::vector<HalfPlane>& room);

// By how much the section stands out beyond what the layer gives, m (negative: free), and through
// which half plane.
double worst_excess(const SliceSection& section, std::span<const HalfPlane> room,
                    int* which = nullptr);

// Presses the section into the room: what stands out is taken off on its side, the opposite side
// stays; half axes keep at least `least` of their length, then the section moves.
void press_in(SliceSection& section, std::span<const HalfPlane> room, double least);

// How far the section can grow along the axis that points out of the body best until it touches,
// its other side held: a vector along one axis, the new centre's shift; half of the growth. Zero
// when it does not fit as it is.
Vec2 growth_to_touch(const SliceSection& section, std::span<const HalfPlane> room);

}  // namespace ecorche::inline v1
