#include "anatomy/posing/symmetrize_outlines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/volume_polynomial.h"

namespace ecorche {
namespace {

constexpr double kKept = 1e-9,
                 kFine = 1e-12;  // of the volume: how well it is kept, and a root found
constexpr double kSpare = 1e-6;  // of the volume, that outlines hold at most beyond what they must
constexpr int kMostTrials = 12;  // three or four do
constexpr int kMostRounds = 60;  // five or six do
constexpr double kLeastAll = 0.2, kMostAll = 5;  // of the radii, where a belly cannot take it all

using Outlines = std::array<SliceOutline, kMaxStripSlices>;

SliceOutline evened(const SliceOutline& outline, float share) {
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

// What the strip with these outlines holds beyond `volume`.
VolumeCubic<double> excess(std::span<const Ellipse> strip, const Outlines& outlines,
                           const BellyGrowth& law, double volume) {
  VolumeCubic<double> out{-3 / std::numbers::pi * volume, 0, 0, 0};
  const auto section = [&](std::size_t k) -> GrowingSection<double> {
    const Ellipse& e = strip[k];
    const Vec3 a = e.radii.x() * e.axes.col(0), b = e.radii.y() * e.axes.col(1);
    return {{e.center.x(), e.center.y(), e.center.z()},
            {a.x(), a.y(), a.z()},
            {b.x(), b.y(), b.z()},
            double(law.belly[k])};
  };
  const std::size_t last = strip.size() - 1;
  GrowingSection<double> here = section(0);
  PieceAreas areas = piece_areas(outlines[0], outlines[1]);
  for (std::size_t k = 0; k < last; ++k) {
    const GrowingSection<double> next = section(k + 1);
    const PieceAreas next_areas = piece_areas(outlines[k + 1], outlines[std::min(k + 2, last)]);
    out.add(here, next, areas, next_areas.own, law.tube ? 1 : 0);
    here = next;
    areas = next_areas;
  }
  return out;
}

// The ends of the range, and in order what is between of where the cubic turns.
std::array<double, 4> turns(const VolumeCubic<double>& q, double low, double high) {
  const double a = 3 * q.q3, b = 2 * q.q2, root = b * b - 4 * a * q.q1;
  if (root < 0) return {low, high, high, high};
  const double c = -0.5 * (b + std::copysign(std::sqrt(root), b));
  const auto [first, second] = std::minmax({a != 0 ? c / a : high, c != 0 ? q.q1 / c : high});
  return {low, std::clamp(first, low, high), std::clamp(second, low, high), high};
}

// The least x that gives as much as is wanted, or more where that is the low end; else that which
// gives most.
double least(const VolumeCubic<double>& q, double low, double high, double fine) {
  const std::array<double, 4> ends = turns(q, low, high);
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

// The most that it comes to.
double most(const VolumeCubic<double>& q, double low, double high) {
  return q(std::ranges::max(turns(q, low, high), {}, q));
}

// What the belly cannot take goes to all sections.
void share_out(std::span<Ellipse> strip, const Outlines& outlines, bool tube, double volume) {
  std::array<float, kMaxStripSlices> all;
  all.fill(1);
  const BellyGrowth law{{all.data(), strip.size()},
                        tube,
                        tube ? kLeastAll : kLeastAll * kLeastAll,
                        tube ? kMostAll : kMostAll * kMostAll};
  grow(strip, law,
       1 + least(excess(strip, outlines, law, volume), law.low - 1, law.high - 1,
                 kFine * std::abs(volume)));
}

}  // namespace

void grow(std::span<Ellipse> strip, const BellyGrowth& law, double growth) {
  for (std::size_t k = 0; k < strip.size(); ++k) {
    const double g = 1 + double(law.belly[k]) * (growth - 1);
    strip[k].radii =
        Vec2(law.tube ? strip[k].radii.x() * g : strip[k].radii.x(), strip[k].radii.y() * g);
  }
}

double round_out(std::span<Ellipse> strip, const BellyGrowth& law, double volume) {
  if (std::none_of(law.belly.begin(), law.belly.end(), [](float b) { return b > 0; })) return 1;
  const double unit = 3 / std::numbers::pi * std::abs(volume), low = law.low - 1,
               high = law.high - 1;
  Outlines outlines;
  VolumeCubic<double> over;
  const auto even = [&](double share) {
    for (std::size_t k = 0; k < strip.size(); ++k)
      outlines[k] = evened(strip[k].outline, float(share));
    over = excess(strip, outlines, law, volume);
    return most(over, low, high) / unit - 0.5 * kSpare;
  };
  struct Trial {
    double share, over;
  };
  Trial before{0, even(0)};
  if (before.over < 0) {
    Trial latest{1, even(1)};
    // Illinois: the two are on either side of what is looked for, if there is such a share.
    for (int trial = 0; trial < kMostTrials && before.over * latest.over < 0 &&
                        std::abs(latest.over) > 0.5 * kSpare;
         ++trial) {
      const double share =
          latest.share - latest.over * (before.share - latest.share) / (before.over - latest.over);
      const Trial now{share, even(share)};
      if (now.over * latest.over < 0)
        before = latest;
      else
        before.over *= 0.5;
      latest = now;
    }
  }
  const double x = least(over, low, high, kFine * unit);
  for (std::size_t k = 0; k < strip.size(); ++k) strip[k].outline = outlines[k];
  grow(strip, law, 1 + x);
  if (std::abs(over(x)) > kKept * unit) share_out(strip, outlines, law.tube, volume);
  return 1 + x;
}

}  // namespace ecorche
