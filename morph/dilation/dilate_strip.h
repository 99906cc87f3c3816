// One strip of a muscle among its room: stretched with the flesh around it, grown until it touches
// the layer of fat, pressed in where it stands out. Works on the sections themselves; whoever calls
// writes them back to the strip.
#pragma once

#include <span>
#include <vector>

#include "morph/dilation/slice_clearance.h"
#include "morph/dilation/tissue_stretch.h"

namespace ecorche::inline v1 {

struct GrowthLimits {
  std::vector<Vec2> directions = ray_directions(20);
  double clearance = 0.3e-3;  // added to the layer, m
  double most = 2.2;          // a half axis grows to at most this multiple
  double least = 0.35;        // and is pressed to no less than this
};

struct StripCount {
  long long rays = 0, misses = 0;
  int pulled_in = 0, pressed = 0, grown = 0;
  // some section ends so near to the skin that the surface over it may stand out
  bool near_skin = false;

  void add(const StripCount& other);
};

// Ends of a strip that lie in fascia: they go with the flesh around them, as bellies do, where ends
// on bones stay.
struct FreeEnds {
  bool origin = false, insertion = false;
};

// Of each section that lies under another muscle, how high it lies over bone, as a share of the
// outermost one's height; 1 for all others.
std::vector<double> heights_in_room(std::span<const Ellipse> slices, int muscle,
                                    const TissueStretch& flesh);

// Moves and stretches the sections with the flesh around them. `slices`: of `strip`, which gives s
// and the belly. `heights`: of the sections where they were carried to; free ends go no higher, so
// that what lay over them lies over them still.
void stretch_strip(const Strip& strip, std::span<Ellipse> slices, int muscle, FreeEnds ends,
                   std::span<const double> heights, const TissueStretch& flesh);

StripCount grow_strip(const Strip& strip, std::span<Ellipse> slices, bool grows,
                      const SkinRays& rays, const FatLayer& fat, const GrowthLimits& limits);

}  // namespace ecorche::inline v1
