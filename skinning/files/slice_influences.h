// Joint influences of muscle sections, for engines that lack our posing.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/muscles/fascia_surface.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

// The four largest joint weights of each slice, from the path points whose weighted sum is its
// position on the line. #slices, all strips of all muscles in order
std::vector<std::array<Influence, 4>> slice_influences(const Anatomy& anatomy);

// Of the points of fascia, #V, from those of the sections that carry them.
std::vector<std::array<Influence, 4>> fascia_influences(
    const FasciaSurface& surface, std::span<const std::array<Influence, 4>> slices);

}  // namespace ecorche::inline v1
