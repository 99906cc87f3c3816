// Arithmetic on the four strips of a batch at once. Private to posing.
#pragma once

#include "anatomy/posing_table.h"

namespace ecorche {

struct Lane3 {
  Lane x, y, z;
};
inline Lane3 operator+(const Lane3& a, const Lane3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Lane3 operator-(const Lane3& a, const Lane3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Lane3 operator*(const Lane& s, const Lane3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Lane dot(const Lane3& a, const Lane3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Lane3 cross(const Lane3& a, const Lane3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Lane3 unit(const Lane3& a) { return dot(a, a).max(1e-300).rsqrt() * a; }

// What a batch needs while it is posed; lives on the stack.
struct Scratch {
  Lane points[kLanes][kMaxStripSlices];  // x, y, z, 1
  Lane3 line[kMaxStripSlices], tangent[kMaxStripSlices], r[kMaxStripSlices];
  Lane chord[kMaxStripSlices];           // cumulative
  Lane3 center[kMaxStripSlices], width[kMaxStripSlices], thickness[kMaxStripSlices];
  Lane a[kMaxStripSlices], b[kMaxStripSlices], belly[kMaxStripSlices];
};

struct LaneGrowth {
  Lane growth;
  Lane missed;  // that it is off the rest volume, in the unit of PosingBatch.lanes.volume
};

// The growth of the belly, low .. high, that gives the rest volume: tube_volume is a cubic in it, nearly a quadratic.
// `of_rows`: areas of the batch's rows.
inline LaneGrowth find_growth(const PosingBatch& batch, const PosingAreas* of_rows, const Scratch& t, const Lane& low, const Lane& high) {
  const Lane& w = batch.lanes.width_swells;
  Lane q0 = -batch.lanes.volume, q1 = Lane::Zero(), q2 = Lane::Zero(), q3 = Lane::Zero();
  // A product of three axes that grow by f, g and h of the belly's growth.
  const auto add = [&](const Lane& product, const Lane& f, const Lane& g, const Lane& h) {
    q0 += product;
    q1 += product * (f + g + h);
    q2 += product * (f * g + f * h + g * h);
    q3 += product * f * g * h;
  };
  Lane3 a0 = t.a[0] * t.width[0], b0 = t.b[0] * t.thickness[0];
  for (int k = 0; k + 1 < batch.rows; ++k) {
    const Lane3 a1 = t.a[k + 1] * t.width[k + 1], b1 = t.b[k + 1] * t.thickness[k + 1];
    const Lane3 d = t.center[k + 1] - t.center[k];
    const PosingAreas& areas = of_rows[k];
    const Lane s00 = areas.own * t.a[k] * t.b[k] * dot(d, t.tangent[k]);
    const Lane s11 = of_rows[k + 1].own * t.a[k + 1] * t.b[k + 1] * dot(d, t.tangent[k + 1]);
    const Lane3 across_a = cross(d, a0), across_b = cross(d, b0);
    const Lane p = 0.5 * areas.ab * dot(across_a, b1), q = -0.5 * areas.ba * dot(across_b, a1);
    const Lane u = 0.5 * areas.aa * dot(across_a, a1), v = 0.5 * areas.bb * dot(across_b, b1);
    const Lane &g0 = t.belly[k], &g1 = t.belly[k + 1];
    q0 += s00 + p + q + u + v + s11;
    q1 += (w + 1) * (s00 * g0 + s11 * g1) + p * (w * g0 + g1) + q * (w * g1 + g0) + (w * u + v) * (g0 + g1);
    q2 += w * (s00 * g0 * g0 + (p + q + u) * g0 * g1 + s11 * g1 * g1) + v * g0 * g1;
    const Lane3 n0 = cross(a0, b0), n1 = cross(a1, b1);
    add(areas.more_a1 * dot(n0, a1), w * g1, w * g0, g0);
    add(areas.more_b1 * dot(n0, b1), g1, w * g0, g0);
    add(-areas.more_a0 * dot(n1, a0), w * g0, w * g1, g1);
    add(-areas.more_b0 * dot(n1, b0), g0, w * g1, g1);
    a0 = a1;
    b0 = b1;
  }
  const Lane root = (q1 * q1 - 4 * q2 * q0).max(0.0).sqrt();
  // A strip without belly has nothing to grow.
  const Lane least = 0.01 * batch.lanes.volume.abs() + 1e-15;
  Lane x = -2 * q0 / (q1 + root).max(least);
  constexpr int kRounds = 3;  // Newton, from the quadratic's root
  for (int round = 0; round < kRounds; ++round) x -= (q0 + x * (q1 + x * (q2 + x * q3))) / (q1 + x * (2 * q2 + 3 * x * q3)).max(least);
  x = (1 + x).max(low).min(high) - 1;
  return {1 + x, q0 + x * (q1 + x * (q2 + x * q3))};
}

}  // namespace ecorche
