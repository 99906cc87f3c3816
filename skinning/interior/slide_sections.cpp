#include "skinning/interior/slide_sections.h"

#include <algorithm>
#include <array>

namespace ecorche::inline v1 {
namespace {

constexpr double kMostGrown = 1.25, kLeastLeft = 0.8;  // of gaps; what is between stays

using Places = std::array<double, kMaxStripSlices>;

// Where sections go, m along the line: the least of
//   sum (new gap - wanted gap)^2 / gap at rest + sum (new place - place)^2 gap at rest / reach^2
// with the ends held (Thomas' algorithm). Wanted is the gap that is there, within bounds.
void even_places(std::span<const double> gaps, double reach, std::span<const double> places,
                 std::span<double> out) {
  constexpr double kLeastGap = 1e-4;  // m
  const std::size_t last = places.size() - 1;
  const auto gap = [&](std::size_t k) { return std::max(gaps[k], kLeastGap); };
  Places factor{};  // of the place after it, once those before are eliminated
  const auto wanted = [&](std::size_t k) {
    return std::clamp(places[k + 1] - places[k], kLeastLeft * gap(k), kMostGrown * gap(k));
  };
  out[0] = places[0];
  out[last] = places[last];
  for (std::size_t k = 1; k < last; ++k) {
    const double before = 1 / gap(k - 1), after = 1 / gap(k),
                 stay = 0.5 * (gap(k - 1) + gap(k)) / (reach * reach);
    const double pivot = before + after + stay - before * factor[k - 1];
    factor[k] = after / pivot;
    out[k] = (stay * places[k] + before * (wanted(k - 1) + out[k - 1]) - after * wanted(k)) / pivot;
  }
  for (std::size_t k = last - 1; k > 0; --k) out[k] += factor[k] * out[k + 1];
}

}  // namespace

void slide_sections(std::span<const double> gaps, double reach, std::span<MappedSection> strip) {
  const std::size_t count = strip.size();
  if (count < 3) return;
  std::array<MappedSection, kMaxStripSlices> was;
  std::copy(strip.begin(), strip.end(), was.begin());
  Places places{}, to{};
  for (std::size_t k = 1; k < count; ++k)
    places[k] = places[k - 1] + (was[k].center - was[k - 1].center).norm();
  even_places(gaps, reach, std::span(places).first(count), std::span(to).first(count));
  // The line's direction, by the parabola through a section and those beside it.
  const auto slope = [&](std::size_t k) -> Vec3 {
    const std::size_t a = k > 0 ? k - 1 : 0, b = std::min(k + 1, count - 1);
    const auto chord = [&](std::size_t i) -> Vec3 {
      const double gap = places[i + 1] - places[i];
      return gap > 0 ? Vec3((was[i + 1].center - was[i].center) / gap) : Vec3::Zero();
    };
    if (a == k || b == k) return chord(std::min(a, b - 1));
    const double before = places[k] - places[a], after = places[b] - places[k];
    if (before + after <= 0) return Vec3::Zero();
    return (after * chord(a) + before * chord(k)) / (before + after);
  };
  std::size_t at = 0;
  for (std::size_t k = 1; k + 1 < count; ++k) {
    while (at + 2 < count && places[at + 1] < to[k]) ++at;
    const double gap = places[at + 1] - places[at];
    if (gap <= 0) continue;
    const double t = std::clamp((to[k] - places[at]) / gap, 0.0, 1.0);
    const double u = 1 - t;
    strip[k].center = (1 + 2 * t) * u * u * was[at].center +
                      t * t * (3 - 2 * t) * was[at + 1].center +
                      gap * (t * u * u * slope(at) - t * t * u * slope(at + 1));
    strip[k].axes = u * was[at].axes + t * was[at + 1].axes;
  }
}

}  // namespace ecorche::inline v1
