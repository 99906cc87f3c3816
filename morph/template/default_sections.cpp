#include "morph/template/default_sections.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {
namespace {

// Pa at full isometric force (Ker et al. 1988: most limb tendons 10 to 30)
constexpr double kTendonStress = 30e6;
constexpr double kAponeurosis = 0.5;     // of the tendon slack, in muscles of at least kPennate
constexpr double kPennate = 0.17;        // rad
constexpr double kOriginShare = 0.2;     // of the free tendon
constexpr double kLeastBelly = 0.15;     // of the line
constexpr double kFlat = 1.5;            // width over thickness
constexpr double kLeastRadius = 0.8e-3;  // m
constexpr double kMostRadius = 0.25;     // of the line: short, strong muscles stay spindles
constexpr int kSlices = 16;

// Outline of a belly over its length, 1 in the middle: a spindle that is a little fuller than a
// sine.
double outline(double u) {
  return std::pow(std::sin(std::numbers::pi * std::clamp(u, 0.0, 1.0)), 0.75);
}

}  // namespace

void add_default_sections(Strip& strip, const StripForces& f, const Vec3& deep) {
  const double length = line_length(strip.path);
  const double aponeurosis = kAponeurosis * std::min(1.0, f.pennation / kPennate) * f.tendon_slack;
  const double belly =
      f.fibre_length > 0
          ? std::clamp((f.fibre_length * std::cos(f.pennation) + aponeurosis) / length, kLeastBelly,
                       1.0)
          : 0.7;
  strip.belly_begin = kOriginShare * (1 - belly);
  strip.belly_end = strip.belly_begin + belly;
  if (belly > 0.98) {
    strip.belly_begin = 0;
    strip.belly_end = 1;
  }
  const double tendon =
      std::clamp(std::sqrt(f.max_force / kTendonStress / std::numbers::pi), kLeastRadius, 6e-3);

  std::vector<double> s;
  for (int k = 0; k <= kSlices; ++k) s.push_back(double(k) / kSlices);
  const std::vector<Vec3> points = line_points(strip.path, s);
  const std::vector<Vec3> tangents = line_tangents(points);
  std::vector<Station> stations;
  for (int k = 0; k <= kSlices; ++k) {
    Vec3 width = tangents[k].cross(deep);
    if (width.norm() < 0.1 * deep.norm() || deep.isZero()) width = tangents[k].unitOrthogonal();
    stations.push_back({s[k], Vec3::Zero(), width.normalized(), Vec2::Constant(tendon)});
  }
  const auto build = [&](double radius) {
    for (Station& station : stations) {
      const double u =
          outline((station.s - strip.belly_begin) / (strip.belly_end - strip.belly_begin));
      station.radii << tendon + u * radius * std::sqrt(kFlat),
          tendon + u * radius / std::sqrt(kFlat);
    }
    Strip dressed = make_strip(strip.path, stations);
    dressed.wraps = strip.wraps;
    dressed.belly_begin = strip.belly_begin;
    dressed.belly_end = strip.belly_end;
    return dressed;
  };
  double low = 0, high = kMostRadius * length;
  Strip best = build(high);
  if (tube_volume(rest_slices(best)) > f.volume) {
    for (int round = 0; round < 40; ++round) {
      const double middle = (low + high) / 2;
      (tube_volume(rest_slices(build(middle))) > f.volume ? high : low) = middle;
    }
    best = build((low + high) / 2);
  }
  strip = best;
}

}  // namespace ecorche::inline v1
