// Arithmetic on the four strips of a batch at once. Private to posing.
#pragma once

#include "anatomy/posing/posing_table.h"
#include "anatomy/posing/volume_polynomial.h"

namespace ecorche {

using Lane3 = Triple<Lane>;
inline Lane3 unit(const Lane3& a) { return dot(a, a).max(1e-300).rsqrt() * a; }

// What a batch needs while it is posed; lives on the stack.
struct Scratch {
  Lane points[kLanes][kMaxStripSlices];  // x, y, z, 1
  Lane3 line[kMaxStripSlices], tangent[kMaxStripSlices], r[kMaxStripSlices];
  Lane chord[kMaxStripSlices];  // cumulative
  Lane3 center[kMaxStripSlices], width[kMaxStripSlices], thickness[kMaxStripSlices];
  Lane a[kMaxStripSlices], b[kMaxStripSlices], belly[kMaxStripSlices];
};

struct LaneGrowth {
  Lane growth;  // 1 where none gives the rest volume
  Eigen::Array<bool, kLanes, 1> found;
};

// The growth of the belly, low .. high, that gives the rest volume: the root of a cubic that is
// nearly a quadratic. `areas`: of the batch's rows.
inline LaneGrowth find_growth(const PosingBatch& batch, const PosingAreas* areas, const Scratch& t,
                              const Lane& low, const Lane& high) {
  VolumeCubic<Lane> missed{-batch.lanes.volume, Lane::Zero(), Lane::Zero(), Lane::Zero()};
  const auto section = [&](int k) {
    return GrowingSection<Lane>{t.center[k], t.a[k] * t.width[k], t.b[k] * t.thickness[k],
                                t.belly[k]};
  };
  GrowingSection<Lane> here = section(0);
  for (int k = 0; k + 1 < batch.rows; ++k) {
    const GrowingSection<Lane> next = section(k + 1);
    missed.add(here, next, areas[k], areas[k + 1].own, batch.lanes.width_swells);
    here = next;
  }
  const auto& [q0, q1, q2, q3] = missed;
  const Lane root = (q1 * q1 - 4 * q2 * q0).max(0.0).sqrt();
  // A strip without belly has nothing to grow.
  const Lane least = 0.01 * batch.lanes.volume.abs() + 1e-15;
  Lane x = -2 * q0 / (q1 + root).max(least);
  constexpr int kRounds = 3;  // Newton, from the quadratic's root
  for (int round = 0; round < kRounds; ++round) x -= missed(x) / missed.slope(x).max(least);
  x = (1 + x).max(low).min(high) - 1;
  constexpr double kVolumeKept = 1e-6;  // share
  const Eigen::Array<bool, kLanes, 1> found =
      missed(x).abs() <= kVolumeKept * batch.lanes.volume.abs();
  return {found.select(1 + x, 1.0), found};
}

}  // namespace ecorche
