// Effect of activation on the shape of the four strips of a batch while their joints hold still
// (isometric bulge). Private to posing.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "anatomy/muscles/belly_length.h"
#include "anatomy/posing/posing_data.h"

namespace ecorche::inline v1 {

// At full activation, growth of the section at mid-belly relative to that at the ends.
constexpr double kMidBellyGrowth = 0.15;

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

// Areas over those at rest as volume moves from the ends of the belly to its middle. `place`: -1 ..
// 1 along the belly.
inline Double4 gathered(const Double4& effort, const Double4& place) {
  const Double4 arch = (1 - place.square()).max(0.0).square();
  return 1 + kMidBellyGrowth * effort * (1.875 * arch - 1);
}

// What the stretching of a section that bulges makes of its axes: symmetric, so that it turns
// nothing.
struct SectionStretch {
  Double4 wide, thick;  // of an axis along itself
  Double4 aslant;       // along the other
};

// Tubes take what gathers all round, sheets in their thickness. `thickening`: what full effort adds
// in its direction besides, and takes across.
inline SectionStretch bulge(const Double4& effort, const Double4& tube, const Double4& place,
                            const PosingThickening& thickening) {
  const Double4 x = thickening.along_width.cast<double>(),
                y = thickening.along_thickness.cast<double>(), grown = gathered(effort, place);
  const Double4 along = (tube * grown.sqrt() + (1 - tube) * grown) *
                        (1 + thickening.share.cast<double>() * effort),
                across = grown / along, more = along - across;
  return {across + more * x * x, across + more * y * y, more * x * y};
}

// Stretches a section's axes: their directions, orthonormal before, and their lengths, m. Nothing
// changes, to the last bit, where there is no effort.
inline void stretch_axes(const SectionStretch& by, Vec3x4& width, Vec3x4& thickness, Double4& a,
                         Double4& b) {
  const Vec3x4 wide = by.wide * width + by.aslant * thickness,
               thick = by.aslant * width + by.thick * thickness;
  const Double4 wider = (by.wide.square() + by.aslant.square()).sqrt(),
                thicker = (by.thick.square() + by.aslant.square()).sqrt();
  width = (1 / wider) * wide;
  thickness = (1 / thicker) * thick;
  a *= wider;
  b *= thicker;
}

}  // namespace ecorche::inline v1
