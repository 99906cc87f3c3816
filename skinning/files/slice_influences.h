// What carries each section of a muscle when joints move it without our own posing: shares of
// joints, for engines.
#pragma once

#include <array>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/bind/bind.h"

namespace ecorche {

// Of the path points that a slice's place on its line is a weighted sum of, the four largest.
// #slices, all strips of all muscles in order
std::vector<std::array<Influence, 4>> slice_influences(const Anatomy& anatomy);

}  // namespace ecorche
