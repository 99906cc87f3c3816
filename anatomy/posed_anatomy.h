// Muscles in one pose, as posing makes them, contact changes them and surfaces draw them.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/limits.h"

namespace ecorche::inline v1 {

// Bounds of strips that can be posed: a frame keeps them on the stack.
constexpr int kMaxStripSlices = limits::kStripSlices;
constexpr int kMaxPathPoints = limits::kPathPoints;

// The slices of one strip in the flat order of all slices.
struct SliceRange {
  int muscle = 0, strip = 0;
  int begin = 0, end = 0;  // flat slice indices
};

struct PosedAnatomy {
  std::vector<Transform> X_WJ;  // #joints
  std::vector<Ellipse> slices;  // #all slices: muscles, strips, slices in order
  std::vector<float> belly;     // #all slices, now: 1 belly, 0 tendon, smooth between (for colour)
  std::vector<double> lengths;  // #all strips, posed line lengths, m
  // #all strips, factor of the belly's radii (sheets: its square root of the thickness), 1 at rest
  std::vector<double> swelling;
  // #all strips, turn of the insertion about the line against the origin, relative to rest, rad
  std::vector<double> twists;
  // strips whose swelling met its limits 1/3 .. 2.5, so that their tendons swell or shrink, too
  int clamped = 0;
  int overtwisted = 0;  // strips with a twist of more than 100 deg; the excess is taken back
};

std::vector<SliceRange> slice_ranges(const Anatomy& anatomy);  // one a strip, in flat order

}  // namespace ecorche::inline v1
