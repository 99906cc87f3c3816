// The line of one strip in a pose: what posing lays its slices on and moment arms are measured
// along. Private to posing.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "anatomy/posing/posing_data.h"
#include "anatomy/posing/wrapping.h"

namespace ecorche::inline v1 {

inline Double4 homogeneous(const Transform& X, const Vec3& p) {
  return X.matrix().col(0).array() * p.x() + X.matrix().col(1).array() * p.y() +
         X.matrix().col(2).array() * p.z() + X.matrix().col(3).array();
}

inline Double4 posed_point(const PosingPoint& p, const std::vector<Transform>& X_WJ) {
  const Double4 first = homogeneous(X_WJ[p.first], p.in_first);
  if (p.second < 0) return first;
  return p.share * first + (1 - p.share) * homogeneous(X_WJ[p.second], p.in_second);
}

inline Double4 turn(const Transform& X, const Vec3& v) {
  return X.matrix().col(0).array() * v.x() + X.matrix().col(1).array() * v.y() +
         X.matrix().col(2).array() * v.z();
}
inline Double4 turned(const PosingPoint& p, const std::vector<Transform>& X_WJ, const Vec3& v) {
  const Double4 first = turn(X_WJ[p.first], v);
  if (p.second < 0) return first;
  return p.share * first + (1 - p.share) * turn(X_WJ[p.second], v);
}

// Moves points that a closing joint has brought past each other back to where they meet, so that
// the line does not turn back.
inline void keep_order(std::span<const PosingLink> links, const PosingPoint* points,
                       const std::vector<Transform>& X_WJ, Double4* path) {
  for (const PosingLink& link : links) {
    const int i = link.point;
    Double4 along =
        turned(points[i], X_WJ, link.direction) + turned(points[i + 1], X_WJ, link.direction);
    const double ahead = ((path[i + 1] - path[i]) * along).sum(), square = (along * along).sum();
    if (ahead > 0 && ahead * ahead >= link.keep * link.keep * square) continue;  // nearly always
    const double size = std::sqrt(square);
    // Where the bones face each other, "ahead" has no meaning: the move fades out before.
    const double sure = std::clamp((size - 0.1) / 0.8, 0.0, 1.0);
    if (sure <= 0) continue;
    along /= size;
    // Nothing from `keep` on, a parabola down to none of it, then what is missing.
    const double missing = link.keep - ahead / size;
    if (missing <= 0) continue;
    const double wanted =
        missing < link.keep ? missing * missing / (2 * link.keep) : missing - 0.5 * link.keep;
    const double back = sure * sure * (3 - 2 * sure) * wanted /
                        std::sqrt(1 + wanted * wanted / (link.room * link.room));
    path[i] -= (link.part_first * back) * along;
    path[i + 1] += (link.part_second * back) * along;
  }
}

// Slice points of the line: spline, then wraps. `node`: the strip's first weight; `rows`: its
// slices.
inline void lay_strip(const PosingData& data, const PosingStrip& strip, int node, int rows,
                      const std::vector<Transform>& X_WJ, Double4* points) {
  Double4 path[kMaxPathPoints];
  for (int i = 0; i < strip.points; ++i) path[i] = posed_point(data.points[strip.point + i], X_WJ);
  keep_order({data.links.data() + strip.link, std::size_t(strip.links)}, &data.points[strip.point],
             X_WJ, path);
  for (int k = 0; k < rows; ++k) {
    const Double4* p = path + data.firsts[node + k];
    const Double4& w = data.weights[node + k];
    points[k] = w[0] * p[0] + w[1] * p[1] + w[2] * p[2] + w[3] * p[3];
  }
  for (int w = 0; w < strip.wraps; ++w) {
    const PosingWrap& wrap = data.wraps[strip.wrap + w];
    push_out(wrap, data.wrap_slices.data() + wrap.slice, X_WJ[wrap.joint], points);
  }
}

}  // namespace ecorche::inline v1
