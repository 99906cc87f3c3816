// Pushing posed slice points out of a wrap object. Private to pose_anatomy.
#pragma once

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "anatomy/posing_table.h"

namespace ecorche {

// Turns `v` by half of what the unit direction `from` turned to become `x`. That has no meaning when they face each other or x lies
// at the object's centre: the turn fades before, so that it is continuous.
inline Vec3 half_turn(const Vec3& from, const Vec3& x, const Vec3& v) {
  const double size = std::sqrt(x.squaredNorm() + 1e-12);
  const Vec3 to = x / size;
  const double facing = std::clamp((from.dot(to) + 1) / 0.75, 0.0, 1.0), near = std::clamp((size - 0.3) / 0.5, 0.0, 1.0);
  const double share = facing * facing * (3 - 2 * facing) * near * near * (3 - 2 * near);
  const Vec3 half = ((2 - share) * from + share * to).normalized();
  const Vec3 axis = from.cross(half), once = axis.cross(v);
  return v + once + axis.cross(once) / (1 + from.dot(half));
}

// The path must stay on its side of the object, so points are moved along one direction `side`, which turns by half of what
// the still slices at either end have turned about the object since rest. The need for displacement is read off a rounded
// wedge, so that a point that has slipped behind the object is brought back and nothing jumps when the line passes the centre;
// slices may lie as deep as they do at rest.
// Displacements then spread to the neighbours as those of a taut string: a straight decay to the still slices.
inline void push_out(const PosingWrap& wrap, const WrapSlice* slices, const Transform& X_WJ, Lane* points) {
  const Mat3 R = X_WJ.linear();
  const Mat3 to_unit = wrap.to_unit * R.transpose();
  const Vec3 center = to_unit * (R * wrap.center + X_WJ.translation());
  Lane columns[4];
  for (int i = 0; i < 3; ++i) columns[i] << to_unit.col(i).array(), 0;
  columns[3] << -center.x(), -center.y(), -center.z(), 0;
  const auto seen = [&](int k) -> Lane {
    return columns[0] * points[k][0] + columns[1] * points[k][1] + columns[2] * points[k][2] + columns[3];
  };
  const auto still = [&](int k) -> Vec3 {
    Vec3 x = seen(k).head<3>();
    if (wrap.cylinder) x.z() = 0;
    return x;
  };
  const Vec3 side = half_turn(wrap.end_at, still(wrap.end), half_turn(wrap.begin_at, still(wrap.begin), wrap.side));

  double need[kMaxStripSlices];
  bool any = false;
  for (int k = wrap.begin + 1; k < wrap.end; ++k) {
    const Lane at = seen(k);
    Vec3 x(at[0], at[1], at[2]);
    double fade = 1;
    if (wrap.cylinder) {
      fade = std::clamp(2 - std::abs(x.z()), 0.0, 1.0);  // past the cylinder's end the push dies away over half its length
      x.z() = 0;
    }
    const double u = x.dot(side);
    const double below = wedge_height(std::max(0.0, x.squaredNorm() - u * u)) - u - slices[k - wrap.begin].depth;
    // Zero below -soft, a parabola up to +soft, then the depth itself.
    const double soft = below <= -wrap.soft ? 0 : below >= wrap.soft ? below : (below + wrap.soft) * (below + wrap.soft) / (4 * wrap.soft);
    // What has passed the object altogether, out at its far side, is let go.
    const double gone = std::clamp((u + 3) / 2, 0.0, 1.0);
    const double room = slices[k - wrap.begin].room, over = soft - 0.5 * room;
    need[k] = fade * gone * gone * (3 - 2 * gone) * (over > 0 ? 0.5 * room + over * room / (room + 2 * over) : soft);
    any = any || need[k] > 0;
  }
  if (!any) return;

  double push[kMaxStripSlices];
  std::fill(push + wrap.begin, push + wrap.end + 1, 0.0);
  for (int k = wrap.begin + 1; k < wrap.end; ++k) {
    if (!(need[k] > 0)) continue;
    for (int i = wrap.begin + 1; i <= k; ++i) push[i] = std::max(push[i], need[k] * (i - wrap.begin) / (k - wrap.begin));
    for (int i = k + 1; i < wrap.end; ++i) push[i] = std::max(push[i], need[k] * (wrap.end - i) / (wrap.end - k));
  }
  const Vec3 step = R * (wrap.from_unit * side);
  double before = 0;
  for (int k = wrap.begin + 1; k < wrap.end; ++k) {
    const double smooth = 0.25 * before + 0.5 * push[k] + 0.25 * push[k + 1];
    before = push[k];
    points[k].head<3>() += (std::max(push[k], smooth) * step).array();
  }
}

}  // namespace ecorche
