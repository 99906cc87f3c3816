#include "anatomy/authoring/trace_section.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/compute/cholesky.h"
#include "anatomy/geometry/ellipse_fit.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kTurnTraceSection = 2 * std::numbers::pi;
constexpr double kHidden = 0.01;  // of the rays' length: more, and a better place is looked for
constexpr int kLookRays = 16;     // a place that is tried
constexpr double kTrace = 1e-4;   // weight of the mean factor, a point
constexpr double kLeastFactor = 0.05;  // of the mean
constexpr double kSoundArea = 0.3;  // of the star's: less is no area but a mesh that does not close

using Cut2 = std::array<Vec2, 2>;

std::vector<Cut2> flat(const CutPlane& plane, const Section& section) {
  std::vector<Cut2> out;
  const auto at = [&](const Vec3& p) {
    return Vec2((p - plane.point).dot(plane.u), (p - plane.point).dot(plane.v));
  };
  for (const auto& [a, b] : section.cuts) out.push_back({at(a), at(b)});
  return out;
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

// Distances at which a ray crosses the cut, rising.
void crossings(std::span<const Cut2> cuts, const Vec2& from, const Vec2& direction,
               std::vector<double>& out) {
  out.clear();
  for (const auto& [a, b] : cuts) {
    const double sa = cross(direction, a - from), sb = cross(direction, b - from);
    if ((sa >= 0) == (sb >= 0)) continue;
    const double t = (a + sa / (sa - sb) * (b - a) - from).dot(direction);
    if (t > 0) out.push_back(t);
  }
  std::sort(out.begin(), out.end());
}

SectionOutline shoot(std::span<const Cut2> cuts, const Vec2& from, int rays) {
  SectionOutline out;
  out.from = from;
  std::vector<double> met;
  double reach = 0, seen = 0;
  for (int k = 0; k < rays; ++k) {
    const double angle = kTurnTraceSection * k / rays;
    const Vec2 direction(std::cos(angle), std::sin(angle));
    crossings(cuts, from, direction, met);
    if (met.empty()) {
      ++out.missed;
      continue;
    }
    // Taken off in turn from the outermost inwards: what lies between the crossings is inside and
    // outside by turns.
    double sign = 1;
    for (auto t = met.rbegin(); t != met.rend(); ++t, sign = -sign)
      out.area += 0.5 * sign * *t * *t * kTurnTraceSection / rays;
    out.points.push_back(from + met.back() * direction);
    reach += met.back();
    seen += met.size() % 2 == 1 ? met.front() : 0;
  }
  out.hidden = reach > 0 ? 1 - seen / reach : 1;
  Vec2 moment = Vec2::Zero();
  for (std::size_t k = 0; k < out.points.size(); ++k) {
    const Vec2 a = out.points[k] - from, b = out.points[(k + 1) % out.points.size()] - from;
    const double piece = 0.5 * cross(a, b);
    out.star_area += piece;
    moment += piece * (a + b) / 3;
  }
  out.centroid = out.star_area > 0 ? Vec2(from + moment / out.star_area) : from;
  if (out.area < kSoundArea * out.star_area) out.area = out.star_area;
  return out;
}

double badness(const SectionOutline& outline, int rays) {
  return outline.hidden + double(outline.missed) / rays;
}

// Middles of what rays from a point cross of the inside, tried in turn; what sees most of the
// outline.
Vec2 best_view(std::span<const Cut2> cuts, const Vec2& from) {
  Vec2 best = from;
  double least = badness(shoot(cuts, from, kLookRays), kLookRays);
  std::vector<double> met;
  for (int round = 0; round < 2; ++round) {
    const Vec2 base = best;
    for (int k = 0; k < kLookRays; ++k) {
      const double angle = kTurnTraceSection * (k + 0.5) / kLookRays;
      const Vec2 direction(std::cos(angle), std::sin(angle));
      crossings(cuts, base, direction, met);
      if (met.size() % 2 == 1) met.insert(met.begin(), 0.0);
      for (std::size_t i = 0; i + 1 < met.size(); i += 2) {
        const Vec2 place = base + 0.5 * (met[i] + met[i + 1]) * direction;
        const double now = badness(shoot(cuts, place, kLookRays), kLookRays);
        if (now < least) least = now, best = place;
      }
    }
  }
  return best;
}

// Factors of the ellipse whose outline, linear between its directions, comes closest to the points
// (least squares).
SliceOutline outline_factors(std::span<const Vec2> points, const Vec2& from, const Vec2& along,
                             const Vec2& radii) {
  using Square = Eigen::Matrix<double, kOutlinePoints, kOutlinePoints>;
  Square A = kTrace * double(points.size()) * Square::Identity();
  Eigen::Matrix<double, kOutlinePoints, 1> b = Eigen::Matrix<double, kOutlinePoints, 1>::Zero();
  const Vec2 aside(-along.y(), along.x());
  double mean = 0;
  for (const Vec2& p : points) {
    const Vec2 scaled((p - from).dot(along) / radii.x(), (p - from).dot(aside) / radii.y());
    double place = std::atan2(scaled.y(), scaled.x()) / kTurnTraceSection * kOutlinePoints;
    if (place < 0) place += kOutlinePoints;
    const int i = int(place) % kOutlinePoints, next = (i + 1) % kOutlinePoints;
    const double share = place - std::floor(place), factor = scaled.norm();
    A(i, i) += (1 - share) * (1 - share), A(next, next) += share * share;
    A(i, next) += share * (1 - share), A(next, i) += share * (1 - share);
    b[i] += (1 - share) * factor, b[next] += share * factor;
    mean += factor / double(points.size());
  }
  b.array() +=
      kTrace * double(points.size()) * mean;  // directions that no point lies near take the mean
  const Eigen::Matrix<double, kOutlinePoints, 1> solved = solve_ldlt(A, b);
  SliceOutline out;
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = float(std::max(solved[i], kLeastFactor * mean));
  return out;
}

// The rays again, even in the eccentric angle, so that the ends of a flat section get as many as
// its sides.
std::vector<Vec2> even_in_ellipse(const SectionOutline& outline, const Vec2& along,
                                  const Vec2& radii) {
  std::vector<Vec2> out;
  std::vector<double> met;
  const Vec2 aside(-along.y(), along.x());
  const std::size_t rays = 4 * kOutlinePoints;
  for (std::size_t k = 0; k < rays; ++k) {
    const double angle = kTurnTraceSection * double(k) / double(rays);
    const Vec2 direction =
        (std::cos(angle) * radii.x() * along + std::sin(angle) * radii.y() * aside).normalized();
    crossings(outline.cuts, outline.from, direction, met);
    if (!met.empty()) out.push_back(outline.from + met.back() * direction);
  }
  return out;
}

}  // namespace

SectionOutline outline_of(const CutPlane& plane, const Section& section, int rays) {
  const std::vector<Cut2> cuts = flat(plane, section);
  const Vec3 d = section.nearest - plane.point;
  Vec2 from = Vec2::Zero();
  SectionOutline out = shoot(cuts, from, rays);
  if (2 * out.missed >
      rays) {  // the line runs outside: begin inside, just behind the nearest point of the outline
    from = 1.02 * Vec2(d.dot(plane.u), d.dot(plane.v));
    out = shoot(cuts, from, rays);
  }
  for (int round = 0; round < 2; ++round) {
    const SectionOutline again = shoot(cuts, out.centroid, rays);
    if (again.missed > out.missed) break;
    out = again;
  }
  if (badness(out, rays) > kHidden) out = shoot(cuts, best_view(cuts, out.from), rays);
  out.cuts = cuts;
  return out;
}

std::vector<std::optional<Ellipse>> outlined_sections(std::span<const CutPlane> planes,
                                                      std::span<const SectionOutline> outlines) {
  std::vector<std::optional<Ellipse2>> fitted;
  std::vector<Vec2>
      turns;  // twice the angle of the longer axis, the longer the flatter the section
  for (const SectionOutline& outline : outlines) {
    const bool seen =
        2 * outline.missed <= int(outline.points.size()) + outline.missed && outline.area > 0;
    fitted.push_back(seen ? fit_ellipse(outline.points) : std::nullopt);
    const auto& e = fitted.back();
    turns.push_back(e ? Vec2((1 - e->radii.y() / e->radii.x()) *
                             Vec2(std::cos(2 * e->angle), std::sin(2 * e->angle)))
                      : Vec2(Vec2::Zero()));
  }
  std::vector<std::optional<Ellipse>> out(outlines.size());
  double last = 0;
  bool first = true;
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    if (!fitted[k]) continue;
    const Vec2 turn =
        turns[k > 0 ? k - 1 : k] + 2 * turns[k] + turns[k + 1 < turns.size() ? k + 1 : k];
    double angle = 0.5 * std::atan2(turn.y(), turn.x());
    if (!first) angle -= std::numbers::pi * std::round((angle - last) / std::numbers::pi);
    last = angle, first = false;
    const Vec2 along(std::cos(angle), std::sin(angle)), aside(-along.y(), along.x());
    // The ellipse's radii along these axes, and its area made that of the section.
    const Eigen::Rotation2Dd off(fitted[k]->angle - angle);
    const Eigen::Matrix2d turned = off.toRotationMatrix();
    const Eigen::Matrix2d shape =
        turned * fitted[k]->radii.cwiseAbs2().asDiagonal() * turned.transpose();
    Vec2 radii = shape.diagonal().cwiseSqrt();
    SliceOutline factors =
        outline_factors(even_in_ellipse(outlines[k], along, radii), outlines[k].from, along, radii);
    const double share = outline_area(factors);
    if (!(share > 0)) continue;
    for (float& f : factors) f = float(double(f) / std::sqrt(share));
    radii *= std::sqrt(outlines[k].area / (std::numbers::pi * radii.x() * radii.y()));
    Ellipse e;
    e.center = planes[k].at(outlines[k].from);
    e.axes.col(0) = along.x() * planes[k].u + along.y() * planes[k].v;
    e.axes.col(2) = planes[k].normal;
    e.axes.col(1) = planes[k].normal.cross(e.axes.col(0));
    e.radii = radii;
    e.outline = factors;
    out[k] = e;
  }
  return out;
}

}  // namespace ecorche::inline v1
