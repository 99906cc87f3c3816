#include "anatomy/muscles/transform_muscles.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kStep = 0.005;  // m, for directions by differences

// Local derivative of the map of a carrier, by central differences.
Mat3 derivative(const Vec3& point, const PathPoint& carrier, const CarryMap& map) {
  Mat3 D;
  for (int i = 0; i < 3; ++i) {
    const Vec3 step = kStep * Vec3::Unit(i);
    D.col(i) = (carry_point(point + step, carrier, map) - carry_point(point - step, carrier, map)) /
               (2 * kStep);
  }
  return D;
}

Wrap carry_wrap(const Wrap& wrap, const CarryMap& map) {
  PathPoint carrier;
  carrier.joints[0] = wrap.joint;
  Wrap moved = wrap;
  const Mat3 D = derivative(wrap.X_WO.translation(), carrier, map);
  const Svd3 parts = svd(D);
  const Mat3 turn = parts.U * parts.V.transpose();
  moved.X_WO.translation() = map(wrap.X_WO.translation(), wrap.joint);
  moved.X_WO.linear() = turn * wrap.X_WO.linear();
  if (moved.X_WO.linear().determinant() < 0)
    moved.X_WO.linear().col(0) *= -1;  // a mirror; the object is its own mirror image
  for (int i = 0; i < 3; ++i) moved.radii[i] *= (D * wrap.X_WO.linear().col(i)).norm();
  // Round things stay round.
  if (wrap.kind == Wrap::Kind::sphere) moved.radii.setConstant(std::cbrt(moved.radii.prod()));
  if (wrap.kind == Wrap::Kind::cylinder)
    moved.radii.head<2>().setConstant(std::sqrt(moved.radii[0] * moved.radii[1]));
  return moved;
}

}  // namespace

Vec3 carry_point(const Vec3& point, const PathPoint& carrier, const CarryMap& map) {
  if (carrier.placing_joint >= 0) return map(point, carrier.placing_joint);
  Vec3 p = map(point, carrier.joints[0]);
  if (carrier.joints[1] >= 0 && carrier.share < 1)
    p = carrier.share * p + (1 - carrier.share) * map(point, carrier.joints[1]);
  return p;
}

Strip carry_strip(const Strip& strip, const CarryMap& map, const CarryMap& inner,
                  EndsInFlesh ends) {
  const CarryMap& flesh = inner ? inner : map;
  Strip moved = strip;
  for (size_t k = 0; k < moved.path.size(); ++k) {
    const bool on_bone =
        (k == 0 && !ends.origin) || (k + 1 == moved.path.size() && !ends.insertion);
    moved.path[k].rest = carry_point(moved.path[k].rest, moved.path[k], on_bone ? map : flesh);
  }
  for (Wrap& wrap : moved.wraps) wrap = carry_wrap(wrap, map);
  moved.rest_length = line_length(moved.path);
  moved.reference = derivative(strip.path[0].rest, strip.path[0], map) * strip.reference;
  if (strip.slices.size() < 2) return moved;

  // Each slice turns with the bones of the two path points around it.
  const std::vector<Ellipse> old = rest_slices(strip);
  std::vector<double> s;
  for (const Slice& slice : strip.slices) s.push_back(slice.s);
  const std::vector<Vec3> points = line_points(strip.path, s);
  const std::vector<double> knots = path_parameters(strip.path);
  std::vector<Station> stations;
  std::vector<Vec3> thickness;
  for (size_t k = 0; k < s.size(); ++k) {
    size_t b = 1;
    while (b + 1 < knots.size() && knots[b] < s[k]) ++b;
    const double gap = knots[b] - knots[b - 1];
    const double share = gap > 0 ? std::clamp((s[k] - knots[b - 1]) / gap, 0.0, 1.0) : 0;
    const Mat3 D = (1 - share) * derivative(points[k], strip.path[b - 1], flesh) +
                   share * derivative(points[k], strip.path[b], flesh);
    Station station;
    station.s = s[k];
    station.width = D * old[k].axes.col(0);
    station.offset = D * (old[k].center - points[k]);
    station.radii = strip.slices[k].radii;
    stations.push_back(station);
    thickness.push_back(D * old[k].axes.col(1));
  }
  Strip sections = make_strip(moved.path, stations);
  moved.slices = std::move(sections.slices);
  moved.reference = sections.reference;
  const std::vector<Ellipse> now = rest_slices(moved);
  for (size_t k = 0; k < now.size(); ++k)
    moved.slices[k].outline =
        flipped_outline(strip.slices[k].outline, now[k].axes.col(0).dot(stations[k].width) < 0,
                        now[k].axes.col(1).dot(thickness[k]) < 0);
  return moved;
}

std::vector<Muscle> carry_muscles(const std::vector<Muscle>& muscles, const CarryMap& map) {
  std::vector<Muscle> moved = muscles;
  for (Muscle& muscle : moved)
    for (Strip& strip : muscle.strips) strip = carry_strip(strip, map);
  return moved;
}

void scale_radii(Strip& strip, const Vec2& factors) {
  for (Slice& slice : strip.slices) {
    slice.radii = slice.radii.cwiseProduct(factors);
    slice.offset = slice.offset.cwiseProduct(factors);
  }
}

double rest_volume(const Muscle& muscle) {
  double volume = 0;
  for (const Strip& strip : muscle.strips)
    if (strip.slices.size() >= 2) volume += tube_volume(rest_slices(strip));
  return volume;
}

void widen_to_volume(Muscle& muscle) {
  const double now = rest_volume(muscle);
  if (now <= 0) return;
  for (Strip& strip : muscle.strips)
    scale_radii(strip, Vec2::Constant(std::sqrt(muscle.volume / now)));
  muscle.volume = rest_volume(muscle);
}

}  // namespace ecorche::inline v1
