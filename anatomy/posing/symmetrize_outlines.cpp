#include "anatomy/posing/symmetrize_outlines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "anatomy/posed_anatomy.h"
#include "anatomy/posing/volume_polynomial.h"

namespace ecorche::inline v1 {
namespace {

// Relative to the volume: error up to which it counts as kept, tolerance of a root, and surplus
// that symmetrized outlines may hold.
constexpr double kKept = 1e-9, kFine = 1e-12, kSpare = 1e-6;
constexpr int kMostTrials = 12;  // of a degree of symmetry; three or four suffice
constexpr int kMostRounds = 60;  // of a root; five or six suffice
// Range of the scale of all sections where the belly alone does not suffice.
constexpr double kLeastAll = 0.2, kMostAll = 5;

using Outlines = std::array<SliceOutline, kMaxStripSlices>;

// `share`: 0 as it is .. 1 centrally symmetric; the area stays.
SliceOutline symmetrized(const SliceOutline& outline, float share) {
  constexpr std::size_t half = kOutlinePoints / 2;
  SliceOutline out;
  for (std::size_t i = 0; i < half; ++i) {
    const float here = outline[i] * outline[i], there = outline[i + half] * outline[i + half],
                given = share * 0.5f * (there - here);
    out[i] = std::sqrt(here + given);
    out[i + half] = std::sqrt(there - given);
  }
  return out;
}

// Volume of the strip with these outlines beyond `volume`.
VolumePolynomial<double> excess(std::span<const Ellipse> strip, const Outlines& outlines,
                                const BellyScaling& law, double volume) {
  VolumePolynomial<double> out{-3 / std::numbers::pi * volume, 0, 0, 0};
  const auto section = [&](std::size_t k) -> ScaledSection<double> {
    const Ellipse& e = strip[k];
    const Vec3 a = e.radii.x() * e.axes.col(0), b = e.radii.y() * e.axes.col(1);
    return {{e.center.x(), e.center.y(), e.center.z()},
            {a.x(), a.y(), a.z()},
            {b.x(), b.y(), b.z()},
            double(law.belly[k])};
  };
  const std::size_t last = strip.size() - 1;
  ScaledSection<double> here = section(0);
  PieceAreas areas = piece_areas(outlines[0], outlines[1]);
  for (std::size_t k = 0; k < last; ++k) {
    const ScaledSection<double> next = section(k + 1);
    const PieceAreas next_areas = piece_areas(outlines[k + 1], outlines[std::min(k + 2, last)]);
    out.add(here, next, areas, next_areas.own, law.tube ? 1 : 0);
    here = next;
    areas = next_areas;
  }
  return out;
}

// The ends of the range, and between them, in order, the extrema of the cubic that lie there.
std::array<double, 4> extrema(const VolumePolynomial<double>& q, double low, double high) {
  const double a = 3 * q.q3, b = 2 * q.q2, root = b * b - 4 * a * q.q1;
  if (root < 0) return {low, high, high, high};
  const double c = -0.5 * (b + std::copysign(std::sqrt(root), b));
  const auto [first, second] = std::minmax({a != 0 ? c / a : high, c != 0 ? q.q1 / c : high});
  return {low, std::clamp(first, low, high), std::clamp(second, low, high), high};
}

// The least x that gives enough volume; else the one that gives most.
double least(const VolumePolynomial<double>& q, double low, double high, double fine) {
  const std::array<double, 4> ends = extrema(q, low, high);
  const auto enough = std::find_if(ends.begin(), ends.end(), [&](double x) { return q(x) >= 0; });
  if (enough == ends.end()) return std::ranges::max(ends, {}, q);
  if (enough == ends.begin()) return low;
  double below = enough[-1], above = enough[0], x = above;
  for (int round = 0; round < kMostRounds && std::abs(q(x)) > fine; ++round) {
    (q(x) < 0 ? below : above) = x;
    const double newton = x - q(x) / q.slope(x);
    x = newton > below && newton < above ? newton : 0.5 * (below + above);
  }
  return x;
}

// The largest value of the range.
double most(const VolumePolynomial<double>& q, double low, double high) {
  return q(std::ranges::max(extrema(q, low, high), {}, q));
}

// Scales all sections by what the belly cannot take.
void scale_all(std::span<Ellipse> strip, const Outlines& outlines, bool tube, double volume) {
  std::array<float, kMaxStripSlices> all;
  all.fill(1);
  const BellyScaling law{{all.data(), strip.size()},
                         tube,
                         tube ? kLeastAll : kLeastAll * kLeastAll,
                         tube ? kMostAll : kMostAll * kMostAll};
  scale_belly(strip, law,
              1 + least(excess(strip, outlines, law, volume), law.low - 1, law.high - 1,
                        kFine * std::abs(volume)));
}

}  // namespace

void scale_belly(std::span<Ellipse> strip, const BellyScaling& law, double scale) {
  for (std::size_t k = 0; k < strip.size(); ++k) {
    const double g = 1 + double(law.belly[k]) * (scale - 1);
    strip[k].radii =
        Vec2(law.tube ? strip[k].radii.x() * g : strip[k].radii.x(), strip[k].radii.y() * g);
  }
}

double symmetrize_outlines(std::span<Ellipse> strip, const BellyScaling& law, double volume) {
  if (std::none_of(law.belly.begin(), law.belly.end(), [](float b) { return b > 0; })) return 1;
  const double unit = 3 / std::numbers::pi * std::abs(volume), low = law.low - 1,
               high = law.high - 1;
  Outlines outlines;
  VolumePolynomial<double> over;
  const auto surplus = [&](double share) {
    for (std::size_t k = 0; k < strip.size(); ++k)
      outlines[k] = symmetrized(strip[k].outline, float(share));
    over = excess(strip, outlines, law, volume);
    return most(over, low, high) / unit - 0.5 * kSpare;
  };
  struct Trial {
    double share, over;
  };
  Trial before{0, surplus(0)};
  if (before.over < 0) {
    Trial latest{1, surplus(1)};
    // Regula falsi (Illinois): the root lies between the two trials, if there is one.
    for (int trial = 0; trial < kMostTrials && before.over * latest.over < 0 &&
                        std::abs(latest.over) > 0.5 * kSpare;
         ++trial) {
      const double share =
          latest.share - latest.over * (before.share - latest.share) / (before.over - latest.over);
      const Trial now{share, surplus(share)};
      if (now.over * latest.over < 0)
        before = latest;
      else
        before.over *= 0.5;
      latest = now;
    }
  }
  const double x = least(over, low, high, kFine * unit);
  for (std::size_t k = 0; k < strip.size(); ++k) strip[k].outline = outlines[k];
  scale_belly(strip, law, 1 + x);
  if (std::abs(over(x)) > kKept * unit) scale_all(strip, outlines, law.tube, volume);
  return 1 + x;
}

}  // namespace ecorche::inline v1
