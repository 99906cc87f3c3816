#include "anatomy/contact/press_outline.h"

#include <cmath>

#include "anatomy/contact/section_levels.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kCount = kOutlinePoints, kSamples = kContactDirections;

// Largest share of an outline's factor that is cut back, approached smoothly, 0 .. 1. Nearer to 1,
// sections are cut down to their centre line.
constexpr float kMostCut = 0.85f;
// Largest growth of the free factors that makes up for a cut, approached smoothly, relative. Less:
// the belly has to swell elsewhere; more: free sides stick out.
constexpr float kMostRegrowth = 1.5f;

// An outline by its directions of even and of odd index.
struct Halves {
  Float8 even, odd;
};

inline Float8 next(Float8 v) { return __builtin_shufflevector(v, v, 1, 2, 3, 4, 5, 6, 7, 0); }

inline Halves halves(const SliceOutline& outline) {
  const Float8 low = load8(outline.data()), high = load8(outline.data() + kSamples);
  return {__builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14),
          __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15)};
}

// Area, or the mixed area of two, over the sine of the angle between directions.
inline float area_of(const Halves& a, const Halves& b) {
  return sum(a.even * b.odd + a.odd * next(b.even));
}

// Restores the area of a cut outline where it is free to grow. A factor above the mean (that of a
// circle of the same area) grows the less the longer it is, and one of twice the mean not at all:
// several passes cut a section, and a long side would soon stick out.
inline void restore_area(const Halves& before, const Halves& freedom, float least,
                         Halves& outline) {
  const Float8 mean = all8(std::sqrt(area_of(before, before) / float(kCount)));
  const auto growing = [&](Float8 length) {
    return larger(smaller(length, 2 * mean - length), Float8{});
  };
  const Halves more{freedom.even * growing(outline.even), freedom.odd * growing(outline.odd)};
  const float lost = area_of(before, before) - area_of(outline, outline),
              once = area_of(outline, more) + area_of(more, outline), twice = area_of(more, more);
  if (!(lost > 0)) return;
  const float wanted = 2 * lost / (once + std::sqrt(once * once + 4 * twice * lost) + 1e-9f);
  const float growth = wanted / (1 + wanted / kMostRegrowth);
  outline.even += growth * more.even;
  outline.odd += growth * more.odd;
  const float area = area_of(outline, outline), missing = least * area_of(before, before) - area;
  if (missing <= 0) return;
  // The cut itself is taken back as far as the least area needs: if the whole section swelled
  // instead, its free side would stick out far.
  const Halves back{before.even - outline.even, before.odd - outline.odd};
  const float first = area_of(outline, back) + area_of(back, outline), second = area_of(back, back);
  const float back_share =
      2 * missing /
      (first + std::sqrt(std::max(first * first + 4 * second * missing, 0.0f)) + 1e-9f);
  outline.even += back_share * back.even;
  outline.odd += back_share * back.odd;
}

}  // namespace

void press_outline(const RadialSamples& penetration, const RadialSamples& blocked,
                   SliceOutline& outline, float least) {
  static_assert(kCount == 16 && kSamples == 8);
  const auto left = [](Float8 p) { return 1 - p / root(1 + p * p * (1 / (kMostCut * kMostCut))); };
  const Float8 p = load8(penetration.data()), h = load8(blocked.data()), zero{};
  const Halves before = halves(outline),
               freedom{larger(1 - h, zero), larger(1 - 0.5f * (h + next(h)), zero)};
  Halves cut{before.even * left(p), before.odd * left(0.5f * (p + next(p)))};
  restore_area(before, freedom, least, cut);
  store(__builtin_shufflevector(cut.even, cut.odd, 0, 8, 1, 9, 2, 10, 3, 11), outline.data());
  store(__builtin_shufflevector(cut.even, cut.odd, 4, 12, 5, 13, 6, 14, 7, 15),
        outline.data() + kSamples);
}

}  // namespace ecorche::inline v1
