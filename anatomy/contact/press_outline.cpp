#include <cmath>

#include "anatomy/contact/section_levels.h"

namespace ecorche {
namespace {

constexpr std::size_t kCount = kOutlinePoints, kSpokes = kContactPoints;

constexpr float kMostPress = 0.85f;    // of a factor
constexpr float kMostRegrowth = 1.5f;  // of the factors that are free

// An outline by its even and its odd directions.
struct Halves {
  Eight even, odd;
};

inline Eight next(Eight v) { return __builtin_shufflevector(v, v, 1, 2, 3, 4, 5, 6, 7, 0); }

inline Halves halves(const SliceOutline& outline) {
  const Eight low = load(outline.data()), high = load(outline.data() + kSpokes);
  return {__builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14),
          __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15)};
}

// Area, or that of two mixed, over the sine between directions.
inline float area_of(const Halves& a, const Halves& b) {
  return sum(a.even * b.odd + a.odd * next(b.even));
}

// Gives a pressed outline its area back where it is free to grow. What is longer than an even
// outline grows the less the longer it is, and what is twice as long not at all: a muscle is
// pressed again and again, and there it would soon stick out.
inline void give_back(const Halves& before, const Halves& freedom, float least, Halves& outline) {
  const Eight even = all(std::sqrt(area_of(before, before) / float(kCount)));
  const auto grown = [&](Eight length) {
    return larger(smaller(length, 2 * even - length), Eight{});
  };
  const Halves more{freedom.even * grown(outline.even), freedom.odd * grown(outline.odd)};
  const float lost = area_of(before, before) - area_of(outline, outline),
              once = area_of(outline, more) + area_of(more, outline), twice = area_of(more, more);
  if (!(lost > 0)) return;
  const float wish = 2 * lost / (once + std::sqrt(once * once + 4 * twice * lost) + 1e-9f);
  const float growth = wish / (1 + wish / kMostRegrowth);
  outline.even += growth * more.even;
  outline.odd += growth * more.odd;
  const float area = area_of(outline, outline), missing = least * area_of(before, before) - area;
  if (missing <= 0) return;
  // It goes no farther than that leaves so much: were it to swell as a whole, what is free would
  // stick out far.
  const Halves back{before.even - outline.even, before.odd - outline.odd};
  const float first = area_of(outline, back) + area_of(back, outline), second = area_of(back, back);
  const float share =
      2 * missing /
      (first + std::sqrt(std::max(first * first + 4 * second * missing, 0.0f)) + 1e-9f);
  outline.even += share * back.even;
  outline.odd += share * back.odd;
}

}  // namespace

void press_outline(const ContactSpokes& press, const ContactSpokes& held, SliceOutline& outline,
                   float least) {
  static_assert(kCount == 16 && kSpokes == 8);
  const auto left = [](Eight p) {
    return 1 - p / root(1 + p * p * (1 / (kMostPress * kMostPress)));
  };
  const Eight p = load(press.data()), h = load(held.data()), zero{};
  const Halves before = halves(outline),
               freedom{larger(1 - h, zero), larger(1 - 0.5f * (h + next(h)), zero)};
  Halves pressed{before.even * left(p), before.odd * left(0.5f * (p + next(p)))};
  give_back(before, freedom, least, pressed);
  store(__builtin_shufflevector(pressed.even, pressed.odd, 0, 8, 1, 9, 2, 10, 3, 11),
        outline.data());
  store(__builtin_shufflevector(pressed.even, pressed.odd, 4, 12, 5, 13, 6, 14, 7, 15),
        outline.data() + kSpokes);
}

}  // namespace ecorche
