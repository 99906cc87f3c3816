// Effect of activation on the shape of the four strips of a batch while their joints hold still
// (isometric bulge). Private to posing.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "anatomy/muscles/belly_length.h"
#include "anatomy/posing/posing_data.h"

namespace ecorche::inline v1 {

// At full activation: growth of the section at mid-belly relative to that at the ends, and share of
// the way (in logarithms) from a flat section to a round one.
constexpr double kMidBellyGrowth = 0.15;
constexpr double kFullRounding = 0.3;

struct BatchActivation {
  bool any = false;
  Double4 root = Double4::Zero();  // square root of the activation
};

// Idle lanes too: they repeat their batch's last strip and write it once more.
inline BatchActivation batch_activation(const PosingData& data, const PosingBatch& batch,
                                        std::span<const double> activation) {
  BatchActivation out;
  if (activation.empty()) return out;
  for (int lane = 0; lane < kLanes; ++lane) {
    const double a = activation[data.strip[batch.strip[lane]].muscle];
    if (a > 0) out.root[lane] = std::sqrt(std::min(a, 1.0));
  }
  out.any = (out.root > 0).any();
  return out;
}

// The active belly stretches its tendon and shortens by as much. `belly`, `tendon`: factors of
// their rest lengths.
inline void stretch_tendon(const PosingData& data, const PosingBatch& batch,
                           const BatchActivation& activation, const Double4& whole, Double4& belly,
                           Double4& tendon) {
  const PosingLanes& c = batch.lanes;
  const Double4 belly_rest = c.tendon_end - c.tendon_begin,
                tendon_rest = (c.rest_chords - belly_rest).max(0.0);
  Double4 shortening = Double4::Zero();
  for (int lane = 0; lane < kLanes; ++lane)
    shortening[lane] = data.strip[batch.strip[lane]].compliance.at(
        whole[lane] * c.length_factor[lane], activation.root[lane]);
  shortening = shortening.min(kTendonLimit * tendon_rest).min(kShortLimit * belly_rest * belly);
  belly -= shortening / belly_rest;
  tendon += shortening / tendon_rest.max(1e-9);
}

// Volume moves from the ends of the belly to its middle, and flat sections turn rounder. `place`:
// -1 .. 1 along the belly; `a`, `b`: half width and half thickness, m.
inline void bulge(const Double4& root, const Double4& tube, const Double4& belly,
                  const Double4& place, Double4& a, Double4& b) {
  const Double4 arch = (1 - place.square()).max(0.0).square();
  const Double4 grown = 1 + kMidBellyGrowth * root * belly * (1.875 * arch - 1),
                radius = grown.sqrt();
  a *= 1 + tube * (radius - 1);
  b *= tube * radius + (1 - tube) * grown;
  const Double4 area = a * b, mean = area.sqrt(), share = kFullRounding * root * belly * tube;
  const Double4 rounder_a = a + share * (mean - a), rounder_b = b + share * (mean - b);
  const Double4 back = (area / (rounder_a * rounder_b).max(1e-300)).sqrt();
  a = (area > 0).select(rounder_a * back, a);
  b = (area > 0).select(rounder_b * back, b);
}

}  // namespace ecorche::inline v1
