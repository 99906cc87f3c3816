// Anatomy + pose -> posed slices, every muscle at its rest volume.
//
// The line of each strip is a spline through its posed path points, pushed out of its wraps; slices sit at fixed parameters,
// their frames are rotation-minimising (Wang et al. 2008, 10.1145/1330511.1330513) with the insertion's twist spread along the
// strip; belly radii grow as the line shortens so that the volume stays what it was, tendons keep their section.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche {

// The anatomy flattened for posing: built once a character, read every frame. Slices are flat: muscles, strips, slices in order.
struct PosingTable;  // opaque; see pose_anatomy.cpp

struct SliceRange {
  int muscle = 0, strip = 0;
  int begin = 0, end = 0;  // flat slice indices
};

struct PosedAnatomy {
  std::vector<Transform> X_WJ;   // #joints
  std::vector<Ellipse> slices;   // #all slices
  std::vector<double> lengths;   // #all strips, posed line lengths, m
};

std::vector<SliceRange> slice_ranges(const Anatomy& anatomy);  // one a strip, in flat order

}  // namespace ecorche
