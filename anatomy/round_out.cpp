#include "anatomy/round_out.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

#include "anatomy/muscle_line.h"

namespace ecorche {
namespace {

constexpr int kMostSections = 64;
constexpr int kHalvings = 8;
constexpr double kKept = 1e-9;                       // of the volume
constexpr double kLeastAll = 0.2, kMostAll = 5;      // of the radii, where a belly cannot take it all

void scale(std::span<Ellipse> strip, const BellyGrowth& law, double growth, bool back) {
  for (std::size_t k = 0; k < strip.size(); ++k) {
    double g = 1 + static_cast<double>(law.belly[k]) * (growth - 1);
    if (back) g = 1 / g;
    strip[k].radii = Vec2(law.tube ? strip[k].radii.x() * g : strip[k].radii.x(), strip[k].radii.y() * g);
  }
}

SliceOutline evened(const SliceOutline& outline, float share) {
  constexpr std::size_t half = kOutlinePoints / 2;
  SliceOutline out;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const float here = outline[i] * outline[i], there = outline[(i + half) % kOutlinePoints] * outline[(i + half) % kOutlinePoints];
    out[i] = std::sqrt((1 - share) * here + share * 0.5f * (here + there));
  }
  return out;
}

struct Growth {
  double growth = 1;
  bool reached = false;
};

// The least growth that gives the volume, else that which gives most. The volume is a cubic in the growth.
Growth least_growth(std::span<const Ellipse> strip, const BellyGrowth& law, double volume) {
  std::array<Ellipse, kMostSections> grown;
  const std::span<Ellipse> all(grown.data(), strip.size());
  Eigen::Matrix4d powers;
  Eigen::Vector4d at;
  for (int k = 0; k < 4; ++k) {
    const double g = law.low + (law.high - law.low) * k / 3;
    std::copy(strip.begin(), strip.end(), all.begin());
    scale(all, law, g, false);
    powers.row(k) << 1, g, g * g, g * g * g;
    at[k] = tube_volume(all) - volume;
  }
  const Eigen::Vector4d c = powers.partialPivLu().solve(at);
  const auto over = [&](double g) { return c[0] + g * (c[1] + g * (c[2] + g * c[3])); };
  std::array<double, 4> ends{law.low, law.high, law.high, law.high};  // the cubic rises or falls all the way between them
  const double a = 3 * c[3], b = 2 * c[2], root = b * b - 4 * a * c[1];
  if (root >= 0) {
    const double q = -0.5 * (b + std::copysign(std::sqrt(root), b));
    const double first = a != 0 ? q / a : law.high, second = q != 0 ? c[1] / q : law.high;
    ends[1] = std::clamp(std::min(first, second), law.low, law.high);
    ends[2] = std::clamp(std::max(first, second), law.low, law.high);
  }
  Growth out{law.low, over(law.low) >= 0};
  if (out.reached) return out;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    double low = ends[k], high = ends[k + 1];
    if (over(high) < 0) {
      if (over(high) > over(out.growth)) out.growth = high;
      continue;
    }
    for (int round = 0; round < 60; ++round) (over(0.5 * (low + high)) < 0 ? low : high) = 0.5 * (low + high);
    return {high, true};
  }
  return out;
}

// What the belly cannot take goes to all sections.
void share_out(std::span<Ellipse> strip, bool tube, double volume) {
  if (std::abs(tube_volume(strip) - volume) <= kKept * std::abs(volume)) return;
  std::array<float, kMostSections> all;
  all.fill(1);
  const BellyGrowth law{{all.data(), strip.size()}, tube, tube ? kLeastAll : kLeastAll * kLeastAll, tube ? kMostAll : kMostAll * kMostAll};
  scale(strip, law, least_growth(strip, law, volume).growth, false);
}

}  // namespace

double round_out(std::span<Ellipse> strip, const BellyGrowth& law, double growth, double volume) {
  if (strip.size() > kMostSections || std::none_of(law.belly.begin(), law.belly.end(), [](float b) { return b > 0; })) return growth;
  scale(strip, law, growth, true);
  std::array<Ellipse, kMostSections> trial;
  const std::span<Ellipse> all(trial.data(), strip.size());
  const auto even = [&](double share) {
    std::copy(strip.begin(), strip.end(), all.begin());
    for (Ellipse& e : all) e.outline = evened(e.outline, static_cast<float>(share));
    return least_growth(all, law, volume);
  };
  double too_little = 0, enough = 1;
  if (even(0).reached) enough = 0;
  for (int k = 0; k < kHalvings && enough > 0; ++k) {
    const double share = 0.5 * (too_little + enough);
    (even(share).reached ? enough : too_little) = share;
  }
  const Growth found = even(enough);
  std::copy(all.begin(), all.end(), strip.begin());
  scale(strip, law, found.growth, false);
  share_out(strip, law.tube, volume);
  return found.growth;
}

}  // namespace ecorche
