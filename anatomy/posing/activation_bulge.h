// What effort does to the four strips of a batch though their joints hold still. Private to
// pose_anatomy.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "anatomy/posing/posing_table.h"

namespace ecorche {

constexpr double kGathering = 0.15;  // of the section in mid-belly at full effort, less at the ends
constexpr double kRounding = 0.3;    // of the way from a flat outline to a round one at full effort
// strain of the tendon that is seen; the rest is the aponeurosis', within the belly
constexpr double kTendonLimit = 0.12;
constexpr double kShortLimit = 0.35;  // of the belly

struct Effort {
  bool any = false;
  Lane root = Lane::Zero();  // of the activation
};

// Idle lanes too: they repeat their batch's last strip and write it once more.
inline Effort find_effort(const PosingTable::Data& data, const PosingBatch& batch,
                          std::span<const double> activation) {
  Effort effort;
  if (activation.empty()) return effort;
  for (int lane = 0; lane < kLanes; ++lane) {
    const double a = activation[data.strip[batch.strip[lane]].muscle];
    if (a > 0) effort.root[lane] = std::sqrt(std::min(a, 1.0));
  }
  effort.any = (effort.root > 0).any();
  return effort;
}

// The belly shortens by as much as its tendon gives.
inline void give_way(const PosingTable::Data& data, const PosingBatch& batch, const Effort& effort,
                     const Lane& whole, Lane& belly, Lane& tendon) {
  const PosingLanes& c = batch.lanes;
  const Lane belly_rest = c.tendon_end - c.tendon_begin,
             tendon_rest = (c.rest_chords - belly_rest).max(0.0);
  Lane gives = Lane::Zero();
  for (int lane = 0; lane < kLanes; ++lane)
    gives[lane] = data.strip[batch.strip[lane]].give.at(whole[lane] * c.length_factor[lane],
                                                        effort.root[lane]);
  gives = gives.min(kTendonLimit * tendon_rest).min(kShortLimit * belly_rest * belly);
  belly -= gives / belly_rest;
  tendon += gives / tendon_rest.max(1e-9);
}

// Mid-belly gathers substance from the ends, and flat outlines turn rounder. `place`: -1 .. 1 along
// the belly.
inline void tense(const Lane& root, const Lane& tube, const Lane& belly, const Lane& place, Lane& a,
                  Lane& b) {
  const Lane arch = (1 - place.square()).max(0.0).square();
  const Lane grown = 1 + kGathering * root * belly * (1.875 * arch - 1), radius = grown.sqrt();
  a *= 1 + tube * (radius - 1);
  b *= tube * radius + (1 - tube) * grown;
  const Lane area = a * b, mean = area.sqrt(), share = kRounding * root * belly * tube;
  const Lane rounder_a = a + share * (mean - a), rounder_b = b + share * (mean - b);
  const Lane back = (area / (rounder_a * rounder_b).max(1e-300)).sqrt();
  a = (area > 0).select(rounder_a * back, a);
  b = (area > 0).select(rounder_b * back, b);
}

}  // namespace ecorche
