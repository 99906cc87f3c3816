// Wrap objects: how a strip's rest line lies beside one (fit_wrap, when a table is made), and how
// posed slice points are pushed out of it (push_out, each frame). Private to posing.
#pragma once

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "anatomy/posed_anatomy.h"
#include "anatomy/posing/rest_strip.h"
#include "anatomy/posing/strip_lanes.h"

namespace ecorche::inline v1 {

// All lengths in units of the object: it is the unit ball, or the unit cylinder about z.
struct PosingWrap {
  int joint = 0;
  bool cylinder = false;
  int begin = 0, end = 0;      // slices that hold still at either side; those between are pushed
  Vec3 center = Vec3::Zero();  // in the joint's frame
  std::array<Double4, 3> to_unit{};  // columns, joint directions -> object units, and zeros
  Mat3 from_unit = Mat3::Identity();
  Vec3 side = Vec3::UnitX();  // where the line passes at rest, unit
  Vec3 begin_at = Vec3::UnitX(),
       end_at = Vec3::UnitX();  // unit directions of the still slices at rest
  double soft = 0.1;            // margin over which the push sets in
  int slice = 0;                // first of end - begin + 1 WrapSlice
};

struct WrapSlice {
  float depth = 0;  // below the wedge that is allowed, because the rest line lies there
  float room = 0;   // push that is steep enough, seen from the still slices
};

// Height of the rounded wedge that stands for a wrap: over the unit ball's cap up to kWedgeSine
// from the side axis, then straight down. Points lower than it, seen from the side the line passes
// on, are inside or behind the object.
constexpr double kWedgeSine = 0.7660444431189780;   // sin 50 deg
constexpr double kWedgeSlope = 1.1917535925942100;  // tan 50 deg
constexpr double kWedgeTop = 1.5557238268604120;    // 1 / cos 50 deg
inline double wedge_height(double across_squared) {
  if (across_squared < kWedgeSine * kWedgeSine) return std::sqrt(1 - across_squared);
  return kWedgeTop - kWedgeSlope * std::sqrt(across_squared);
}
inline Double4 wedge_height(const Double4& across_squared) {
  const Double4 cap = (1 - across_squared).max(0.0).sqrt(),
                sides = kWedgeTop - kWedgeSlope * across_squared.sqrt();
  return (across_squared < kWedgeSine * kWedgeSine).select(cap, sides);
}

// One wrap against the rest line: its side, its reach, and how deep the line may be in it. Appends
// to `slices`, sets `depth` (m). False if the line does not lie beside it. `joint`: the wrap's, at
// rest.
bool fit_wrap(const Wrap& wrap, const RestStrip& rest, const Vec3& joint, PosingWrap& out,
              std::vector<WrapSlice>& slices, double& depth);

constexpr int kNormSquarings = 4;  // displacements add up by a norm of power 2^4
constexpr double kBeside = 1.1 * 1.1,
                 // squared distances from the side axis, object units: the wedge fades between
    kFarBeside = 1.7 * 1.7;

// Rotates `v` by half of the rotation that brings the unit direction `from` to `x`. That rotation
// has no meaning where they face each other or x lies at the object's centre: it fades out before,
// so that the result is continuous.
inline Vec3 half_turn(const Vec3& from, const Vec3& x, const Vec3& v) {
  const double size = std::sqrt(x.squaredNorm() + 1e-12);
  const Vec3 to = (1 / size) * x;
  const double facing = std::clamp((from.dot(to) + 1) / 0.75, 0.0, 1.0),
               near = std::clamp((size - 0.3) / 0.5, 0.0, 1.0);
  const double share = facing * facing * (3 - 2 * facing) * near * near * (3 - 2 * near);
  const Vec3 between = (2 - share) * from + share * to;
  const Vec3 half = (1 / between.norm()) * between;
  const Vec3 axis = from.cross(half), once = axis.cross(v);
  return v + once + (1 / (1 + from.dot(half))) * axis.cross(once);
}

// How far the slices from `first` on, as many as there are lanes, must move along `side`, object
// units. None for those from wrap.end on.
inline Double4 push_needed(const PosingWrap& wrap, const WrapSlice* slices, const Double4* columns,
                           const Vec3& side, int first, const Double4* points) {
  Eigen::Matrix4d m;
  Double4 depth, room, counts;
  for (int lane = 0; lane < kLanes; ++lane) {
    const int k = std::min(first + lane, wrap.end);
    m.col(lane) = points[k].matrix();
    depth[lane] = slices[k - wrap.begin].depth;
    room[lane] = slices[k - wrap.begin].room;
    counts[lane] = first + lane < wrap.end ? 1 : 0;
  }
  m.transposeInPlace();
  const Double4 px = m.col(0).array(), py = m.col(1).array(), pz = m.col(2).array(),
                zero = Double4::Zero();
  const auto seen = [&](int r) -> Double4 {
    return columns[0][r] * px + columns[1][r] * py + columns[2][r] * pz + columns[3][r];
  };
  const Double4 x = seen(0), y = seen(1);
  Double4 z = seen(2);
  if (wrap.cylinder) {
    counts *= (2 - z.abs())
                  .max(0.0)
                  .min(1.0);  // past the cylinder's end the push dies away over half its length
    z = zero;
  }
  const Double4 u = side.x() * x + side.y() * y + side.z() * z;
  const Double4 across = (x * x + y * y + z * z - u * u).max(zero);
  const Double4 below = wedge_height(across) - u - depth;
  // Zero below -soft, a parabola up to +soft, then the depth itself.
  const Double4 within = (below + wrap.soft).max(0.0);
  const Double4 soft = (below < wrap.soft).select(within * within * (0.25 / wrap.soft), below);
  // Points that have passed the object altogether, out at its far side, are released.
  const Double4 gone = (0.5 * (u + 3)).max(0.0).min(1.0);
  const Double4 half = 0.5 * room, over = (soft - half).max(0.0);
  // Slices farther out than the object is broad are not behind it: the line has come round it, or
  // turns back beside it. Where it has slipped behind, the slices in its middle take them along.
  const Double4 beside = ((kFarBeside - across) * (1 / (kFarBeside - kBeside))).max(0.0).min(1.0);
  counts *= beside * beside * (3 - 2 * beside);
  return counts * gone * gone * (3 - 2 * gone) *
         (soft.min(half) + over * room / (room + 2 * over).max(1e-300));
}

// The path must stay on its side of the object, so points are moved along one direction `side`,
// which turns by half of what the still slices at either end have turned about the object since
// rest. The need for displacement is read off a rounded wedge, so that a point that has slipped
// behind the object is brought back and nothing jumps when the line passes the centre; slices may
// lie as deep as they do at rest. Displacements then spread to the neighbours as those of a taut
// string: a straight decay to the still slices. They add up by a high norm instead of the largest
// alone, so that one slice takes over from the next without a kink.
inline void push_out(const PosingWrap& wrap, const WrapSlice* slices, const Transform& X_WJ,
                     Double4* points) {
  const auto& X = X_WJ.matrix();
  const Double4 center = X.col(0).array() * wrap.center.x() + X.col(1).array() * wrap.center.y() +
                         X.col(2).array() * wrap.center.z() + X.col(3).array();
  Double4 columns[4];
  for (int i = 0; i < 3; ++i)
    columns[i] = wrap.to_unit[0] * X(i, 0) + wrap.to_unit[1] * X(i, 1) + wrap.to_unit[2] * X(i, 2);
  columns[3] = -(columns[0] * center[0] + columns[1] * center[1] + columns[2] * center[2]);
  const auto seen = [&](int k) -> Double4 {
    return columns[0] * points[k][0] + columns[1] * points[k][1] + columns[2] * points[k][2] +
           columns[3];
  };
  const auto still = [&](int k) -> Vec3 {
    Vec3 x = seen(k).head<3>();
    if (wrap.cylinder) x.z() = 0;
    return x;
  };
  const Vec3 side = half_turn(wrap.end_at, still(wrap.end),
                              half_turn(wrap.begin_at, still(wrap.begin), wrap.side));

  double need[kMaxStripSlices + kLanes];
  bool any = false;
  for (int k = wrap.begin + 1; k < wrap.end; k += kLanes) {
    const Double4 push = push_needed(wrap, slices, columns, side, k, points);
    Eigen::Map<Double4, Eigen::Unaligned>(need + k) = push;
    any = any || (push > 0).any();
  }
  if (!any) return;

  const auto power = [](double x) {
    for (int i = 0; i < kNormSquarings; ++i) x *= x;
    return x;
  };
  double push[kMaxStripSlices];
  push[wrap.begin] = push[wrap.end] = 0;
  double falling = 0, rising = 0;
  for (int k = wrap.begin + 1; k < wrap.end; ++k) {
    push[k] = falling * power(wrap.end - k);
    falling += power(std::max(0.0, need[k]) / (wrap.end - k));
  }
  for (int k = wrap.end - 1; k > wrap.begin; --k) {
    rising += power(std::max(0.0, need[k]) / (k - wrap.begin));
    push[k] += rising * power(k - wrap.begin);
  }
  for (int i = 0; i < kNormSquarings; ++i)
    for (int k = wrap.begin + 1; k < wrap.end; ++k) push[k] = std::sqrt(push[k]);
  const Vec3 step = X_WJ.linear() * (wrap.from_unit * side);
  double before = 0;
  for (int k = wrap.begin + 1; k < wrap.end; ++k) {
    const double smooth = 0.25 * before + 0.5 * push[k] + 0.25 * push[k + 1];
    before = push[k];
    points[k].head<3>() += (std::max(push[k], smooth) * step).array();
  }
}

}  // namespace ecorche::inline v1
