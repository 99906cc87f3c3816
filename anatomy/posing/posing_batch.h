// Arithmetic on the four strips of a batch at once. Private to posing.
#pragma once

#include "anatomy/posed_anatomy.h"
#include "anatomy/posing/posing_data.h"
#include "anatomy/posing/strip_lanes.h"
#include "anatomy/posing/volume_polynomial.h"

namespace ecorche::inline v1 {

// Memory of a batch while it is posed; on the stack.
struct BatchWorkspace {
  Double4 points[kLanes][kMaxStripSlices];  // x, y, z, 1
  Vec3x4 line[kMaxStripSlices], tangent[kMaxStripSlices], r[kMaxStripSlices];
  Double4 chord[kMaxStripSlices];  // cumulative
  Vec3x4 center[kMaxStripSlices], width[kMaxStripSlices], thickness[kMaxStripSlices];
  Double4 a[kMaxStripSlices], b[kMaxStripSlices], belly[kMaxStripSlices];
};

struct VolumeScale {
  Double4 scale;  // of the belly's radii; 1 where none gives the rest volume
  Eigen::Array<bool, kLanes, 1> found;
};

// The scale of the belly, low .. high, that gives the rest volume: the root of a cubic that is
// nearly a quadratic. `areas`: of the batch's rows.
inline VolumeScale find_volume_scale(const PosingBatch& batch, const PosingAreas* areas,
                                     const BatchWorkspace& t, const Double4& low,
                                     const Double4& high) {
  VolumePolynomial<Double4> missed{-batch.lanes.volume, Double4::Zero(), Double4::Zero(),
                                   Double4::Zero()};
  const auto section = [&](int k) {
    return ScaledSection<Double4>{t.center[k], t.a[k] * t.width[k], t.b[k] * t.thickness[k],
                                  t.belly[k]};
  };
  ScaledSection<Double4> here = section(0);
  for (int k = 0; k + 1 < batch.rows; ++k) {
    const ScaledSection<Double4> next = section(k + 1);
    missed.add(here, next, areas[k], areas[k + 1].own, batch.lanes.width_swells);
    here = next;
  }
  const auto& [q0, q1, q2, q3] = missed;
  const Double4 root = (q1 * q1 - 4 * q2 * q0).max(0.0).sqrt();
  // A strip without belly has nothing to scale.
  const Double4 least = 0.01 * batch.lanes.volume.abs() + 1e-15;
  Double4 x = -2 * q0 / (q1 + root).max(least);
  constexpr int kRounds = 3;  // Newton, from the quadratic's root
  for (int round = 0; round < kRounds; ++round) x -= missed(x) / missed.slope(x).max(least);
  x = (1 + x).max(low).min(high) - 1;
  constexpr double kVolumeKept = 1e-6;  // error that counts as found, relative
  const Eigen::Array<bool, kLanes, 1> found =
      missed(x).abs() <= kVolumeKept * batch.lanes.volume.abs();
  return {found.select(1 + x, 1.0), found};
}

}  // namespace ecorche::inline v1
