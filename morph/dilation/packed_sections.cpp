#include "morph/dilation/packed_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche::inline v1 {

namespace {

constexpr std::size_t kDirectionsPackedSections = kOutlinePoints;
// levels of tendons count this much: they keep their room before bellies do
constexpr double kTendonLevel = 0.4;
constexpr int kLevelSteps = 6, kHalvings = 5;
constexpr std::size_t kMostStrips = 16;  // of a muscle, that are looked at

// Direction of (x, y) in units of 2 pi / kOutlinePoints, in [0, kOutlinePoints), to some 1e-5 of
// one: asked for hundreds of thousands of times a round. Odd polynomial for the arc tangent up to
// 1, least largest error.
double direction_place(double x, double y) {
  const double a = std::abs(x), b = std::abs(y), most = std::max(a, b);
  if (most == 0) return 0;
  const double z = std::min(a, b) / most, z2 = z * z;
  double angle =
      z * (0.99997726 +
           z2 * (-0.33262347 +
                 z2 * (0.19354346 + z2 * (-0.11643287 + z2 * (0.05265332 - 0.01172120 * z2)))));
  if (b > a) angle = std::numbers::pi / 2 - angle;
  if (x < 0) angle = std::numbers::pi - angle;
  if (y < 0) angle = 2 * std::numbers::pi - angle;
  const double place = angle * (kOutlinePoints / (2 * std::numbers::pi));
  return place >= kOutlinePoints ? 0 : place;
}

}  // namespace

double rounded(double x) { return std::round(x * 1e6) / 1e6; }

std::vector<Ellipse> rounded_sections(std::span<const Ellipse> slices) {
  const auto each = [](double x) { return rounded(x); };
  std::vector<Ellipse> out(slices.begin(), slices.end());
  for (Ellipse& e : out) {
    e.center = e.center.unaryExpr(each).eval();
    e.axes = e.axes.unaryExpr(each).eval();
    e.radii = e.radii.unaryExpr(each).eval();
  }
  return out;
}

std::vector<std::size_t> slice_begins(std::span<const Muscle> muscles) {
  std::vector<std::size_t> out{0};
  for (const Muscle& muscle : muscles) {
    out.push_back(out.back());
    for (const Strip& strip : muscle.strips) out.back() += strip.slices.size();
  }
  return out;
}

std::size_t outline_place(const MuscleSurface::Term& term) {
  return std::size_t(std::lround(term.place)) % kDirectionsPackedSections;
}

Vec3 root_of(const MuscleSurface& surface, int vertex, std::span<const Ellipse> slices) {
  Vec3 out = Vec3::Zero();
  for (int j = surface.term_begin[vertex]; j < surface.term_begin[vertex + 1]; ++j)
    out += double(surface.terms[j].weight) * slices[surface.terms[j].slice].center;
  return out;
}

PackedSections::PackedSections(const Anatomy& anatomy, const MuscleSurface& surface,
                               std::span<const Ellipse> given, std::span<const int> mirrored)
    : slices(rounded_sections(given)),
      partners(mirrored.begin(), mirrored.end()),
      weights(mirrored.size(), 1.0) {
  std::size_t at = 0;
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) {
    muscle_begin.push_back(at);
    strip_begin.push_back(strips.size());
    const bool sheet = surface.parts[m].sheet;
    for (const Strip& strip : anatomy.muscles[m].strips) {
      strips.push_back({int(m), sheet, at, at + strip.slices.size(),
                        int(sheet ? strip_begin[m] : strips.size())});
      at += strip.slices.size();
      for (const Slice& slice : strip.slices) belly.push_back(belly_weight(strip, slice.s));
    }
  }
  muscle_begin.push_back(at);
  strip_begin.push_back(strips.size());
  thickness.assign(at, 1);
  for (const MuscleSurface::Part& part : surface.parts) {
    const std::size_t m = part.muscle;
    std::fill(thickness.begin() + long(muscle_begin[m]),
              thickness.begin() + long(muscle_begin[m + 1]), double(part.thickness));
  }
  drawn.assign(slices.size() * kDirectionsPackedSections, 0);
  for (const MuscleSurface::Term& t : surface.terms)
    if (t.u != 0 || t.v != 0) drawn[t.slice * kDirectionsPackedSections + outline_place(t)] = 1;
}

Vec3 PackedSections::edge(std::size_t k, std::size_t i) const {
  const Ellipse& e = slices[k];
  const Vec2& d = outline_directions()[i];
  return e.radii.x() * d.x() * e.axes.col(0) + thickness[k] * e.radii.y() * d.y() * e.axes.col(1);
}

void PackedSections::fill(std::size_t k, SliceOutline& outline) const {
  for (std::size_t i = 0; i < kDirectionsPackedSections; ++i) {
    if (is_drawn(k, i)) continue;
    std::size_t before = 1, after = 1;
    while (before < kDirectionsPackedSections &&
           !is_drawn(k, (i + kDirectionsPackedSections - before) % kDirectionsPackedSections))
      ++before;
    while (after < kDirectionsPackedSections &&
           !is_drawn(k, (i + after) % kDirectionsPackedSections))
      ++after;
    if (before == kDirectionsPackedSections) {
      outline[i] = 1;
      continue;
    }
    const float share = float(before) / float(before + after);
    outline[i] = (1 - share) *
                     outline[(i + kDirectionsPackedSections - before) % kDirectionsPackedSections] +
                 share * outline[(i + after) % kDirectionsPackedSections];
  }
}

void mirror_outlines(std::span<const Ellipse> left, std::span<Ellipse> right) {
  if (left.size() != right.size()) return;
  for (std::size_t k = 0; k < right.size(); ++k) {
    const auto turned = [&](int axis) {
      return left[k].axes.col(axis).cwiseProduct(Vec3(-1, 1, 1)).dot(right[k].axes.col(axis)) < 0;
    };
    right[k].outline = flipped_outline(left[k].outline, turned(0), turned(1));
  }
}

void smooth_outlines(std::span<SliceOutline> outlines) {
  const std::vector<SliceOutline> old(outlines.begin(), outlines.end());
  const std::size_t n = old.size();
  for (std::size_t k = 0; k < n; ++k) {
    const SliceOutline &before = old[k > 0 ? k - 1 : k], &after = old[k + 1 < n ? k + 1 : k],
                       &here = old[k];
    for (std::size_t i = 0; i < kDirectionsPackedSections; ++i) {
      const std::size_t left = (i + kDirectionsPackedSections - 1) % kDirectionsPackedSections,
                        right = (i + 1) % kDirectionsPackedSections;
      outlines[k][i] = (4 * here[i] + before[i] + after[i] + here[left] + here[right]) / 8;
    }
  }
}

// 0 on the line of a section's centre, 1 on its outline, as far as the section speaks for this
// place.
double PackedSections::level(std::size_t k, const Vec3& p) const {
  const Ellipse& e = slices[k];
  const Vec3 d = p - e.center;
  double x = d.dot(e.axes.col(0)) / std::max(e.radii.x(), 1e-6);
  if (!is_drawn(k, x > 0 ? 0 : kDirectionsPackedSections / 2)) x = 0;  // the sheet goes on there
  const double y = d.dot(e.axes.col(1)) / std::max(thickness[k] * e.radii.y(), 1e-6);
  return std::sqrt(x * x + y * y) /
         std::max(outline_factor(e.outline, direction_place(x, y)), 1e-3);
}

double PackedSections::level_share(std::size_t slice) const {
  return kTendonLevel + (1 - kTendonLevel) * belly[slice];
}

// The same between a slice and the next one towards the point.
double PackedSections::level_near(const StripPlace& strip, std::size_t k, const Vec3& p) const {
  const Ellipse& e = slices[k];
  const double along = e.axes.col(2).dot(p - e.center);
  const std::size_t next = along > 0 ? std::min(k + 1, strip.end - 1) : k > strip.begin ? k - 1 : k;
  const double here = level_share(k) * level(k, p);
  if (next == k) return here;
  const double step = std::abs(e.axes.col(2).dot(slices[next].center - e.center));
  const double share = std::clamp(std::abs(along) / std::max(step, 1e-6), 0.0, 1.0);
  return (1 - share) * here + share * level_share(next) * level(next, p);
}

// The slice of a strip whose centre is nearest.
std::size_t PackedSections::nearest(const StripPlace& strip, const Vec3& p) const {
  std::size_t best = strip.begin;
  double least = 1e300;
  for (std::size_t k = strip.begin; k < strip.end; ++k) {
    const double d = (slices[k].center - p).squaredNorm();
    if (d < least) least = d, best = k;
  }
  return best;
}

double PackedSections::part(std::size_t k, std::size_t own, const Vec3& direction, double radius,
                            const RayInterval& interval) const {
  const double mine = weights[own] * level_share(k) / radius;
  const double end = std::min(interval.to, radius);
  const auto at = [&](double t) -> Vec3 { return slices[k].center + t * direction; };
  const std::size_t m = interval.solid;
  const Vec3 middle = at(0.5 * (interval.from + end));
  const std::size_t first = strip_begin[m],
                    count = std::min(strip_begin[m + 1] - first, kMostStrips);
  std::array<std::size_t, kMostStrips> near;
  for (std::size_t s = 0; s < count; ++s) near[s] = nearest(strips[first + s], middle);
  const auto theirs = [&](double t) {
    double least = 1e300;
    for (std::size_t s = 0; s < count; ++s)
      least = std::min(least, level_near(strips[first + s], near[s], at(t)));
    return weights[m] * least;
  };
  double low = interval.from, high = -1;
  if (mine * low >= theirs(low)) return low;
  for (int step = 1; step <= kLevelSteps; ++step) {
    const double t = interval.from + (end - interval.from) * step / kLevelSteps;
    if (mine * t >= theirs(t)) {
      high = t;
      break;
    }
    low = t;
  }
  if (high < 0) return radius;
  for (int step = 0; step < kHalvings; ++step) {
    const double half = 0.5 * (low + high);
    (mine * half >= theirs(half) ? high : low) = half;
  }
  return 0.5 * (low + high);
}

}  // namespace ecorche::inline v1
