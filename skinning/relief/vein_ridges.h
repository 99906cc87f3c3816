// Ridges of superficial veins on a skin at rest. Private to the library.
#pragma once

#include <span>
#include <vector>

#include "anatomy/vein_path.h"
#include "skinning/relief/skin_smoothing.h"

namespace ecorche::inline v1 {

// Height at each vertex, m, of what the layer over the veins lets through. A ridge is a Gaussian of
// the distance from its vein; where edges are too long for it, it is wider and as much lower, so
// that it never breaks up into bumps. Where veins meet the higher counts. A layer of h lets
// exp(-(h - kSkinAlone) / kVeinFade) through. `thickness`: #V, m.
std::vector<float> vein_ridges(std::span<const VeinPath> veins, const SurfaceGraph& skin,
                               std::span<const double> thickness);

// m; skin without fat, and of the further layer that leaves a third of a ridge.
constexpr double kSkinAlone = 0.0015, kVeinFade = 0.002;

}  // namespace ecorche::inline v1
