#include "anatomy/posing/wrapping.h"

namespace ecorche::inline v1 {
namespace {

// Half of the distance over which a push sets in: in metres, or as a fraction of a large object's
// radius, whose surface a line meets along its length at once. Less: lines touch down abruptly;
// more: they lift off the surface.
constexpr double kWrapMargin = 0.0015;
constexpr double kWrapMarginRatio = 0.03;
// Largest slope of the push against the distance from a slice that holds still, and the distance
// over which the slope is reached, m.
constexpr double kSteepest = 0.7;
constexpr double kGentle = 0.015;
constexpr double kWrapReach = 4;  // object radii: slices farther off hold still

}  // namespace

bool fit_wrap(const Wrap& wrap, const RestStrip& rest, const Vec3& joint, PosingWrap& out,
              std::vector<WrapSlice>& slices, double& depth) {
  const int n = rest.line.size();
  out.joint = wrap.joint;
  out.cylinder = wrap.kind == Wrap::Kind::cylinder;
  out.center = wrap.X_WO.translation() - joint;
  if (!(wrap.radii.minCoeff() > 1e-4)) return false;
  const Mat3 to_unit = wrap.radii.cwiseInverse().asDiagonal() * wrap.X_WO.linear().transpose();
  for (int i = 0; i < 3; ++i) out.to_unit[i] << to_unit.col(i).array(), 0;
  out.from_unit = wrap.X_WO.linear() * Mat3(wrap.radii.asDiagonal());
  const auto seen = [&](int k) {
    Vec3 x = to_unit * (rest.line[k] - wrap.X_WO.translation());
    if (out.cylinder) x.z() = 0;
    return x;
  };
  int nearest = -1;
  double least = 1e300;
  for (int k = 1; k + 1 < n; ++k) {
    const double beyond =
        out.cylinder ? std::abs((to_unit * (rest.line[k] - wrap.X_WO.translation())).z()) : 0;
    const double d = seen(k).norm();
    if (beyond < 1.5 && d < least) least = d, nearest = k;
  }
  if (nearest < 0 || least > kWrapReach || least < 0.2) return false;
  out.side = seen(nearest).normalized();
  const double mean_radius = out.cylinder ? wrap.radii.x() : std::cbrt(wrap.radii.prod());
  out.soft = std::max(kWrapMargin / mean_radius, kWrapMarginRatio);
  const auto below = [&](int k) {
    const Vec3 x = seen(k);
    const double u = x.dot(out.side);
    return wedge_height(std::max(0.0, x.squaredNorm() - u * u)) - u;
  };
  // Beside the object the line bends round so far that only slices nearer than this one may be
  // pushed.
  const auto beside = [&](int k) {
    const Vec3 x = seen(k);
    const double u = x.dot(out.side);
    return x.squaredNorm() - u * u > kWedgeSine * kWedgeSine && below(k) > -out.soft;
  };
  out.begin = out.end = nearest;
  while (out.begin > 0 && !beside(out.begin - 1) && seen(out.begin).norm() < kWrapReach)
    --out.begin;
  while (out.end + 1 < n && !beside(out.end + 1) && seen(out.end).norm() < kWrapReach) ++out.end;
  out.begin = std::min(out.begin, nearest - 1);
  out.end = std::max(out.end, nearest + 1);
  out.begin_at = seen(out.begin).normalized();
  out.end_at = seen(out.end).normalized();
  out.slice = slices.size();
  depth = 0;
  for (int k = out.begin; k <= out.end; ++k) {
    const double from_still =
        std::min(rest.chord[k] - rest.chord[out.begin], rest.chord[out.end] - rest.chord[k]);
    slices.push_back(
        {std::nextafter(float(std::max(0.0, below(k) + out.soft)), 1e9f),
         float(kSteepest * from_still * from_still / (from_still + kGentle) / mean_radius)});
    if (k > out.begin && k < out.end) depth = std::max(depth, below(k) * mean_radius);
  }
  return true;
}

}  // namespace ecorche::inline v1
