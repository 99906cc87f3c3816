#include "morph/dilation/straighten_strips.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/strip_kinks.h"
#include "anatomy/muscles/surface_reference.h"
#include "morph/dilation/packed_sections.h"

namespace ecorche::inline v1 {
namespace {

// m off the chord, beyond the reference: from 20 mm on a strip counts as torn, against muscles that
// have grown and so bend by some millimetres less. Smaller: strips that go round what lies beneath
// are pressed into it.
constexpr double kMostKink = 0.010;
constexpr int kRounds = 60;       // at most; most strips need none
constexpr double kOfRound = 0.5;  // of what is too much
constexpr int kSpread = 2;        // sections to both sides that go along, less the farther

// One strip by itself; whether it was bent.
bool straighten(const Strip& strip, const Strip& reference, std::span<Ellipse> slices) {
  bool bent = false;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> beyond = kinks_beyond(strip, slices, reference);
    const auto worst = std::ranges::max_element(beyond);
    if (worst == beyond.end() || *worst <= kMostKink) return bent;
    bent = true;
    const std::vector<Vec3> off = off_chords(strip, slices, kKinkReach);
    const int n = int(slices.size()), at = int(worst - beyond.begin());
    const Vec3 back =
        -kOfRound * (*worst - kMostKink / 2) * off[std::size_t(at)].stableNormalized();
    for (int k = std::max(1, at - kSpread); k <= std::min(n - 2, at + kSpread); ++k) {
      Ellipse& slice = slices[std::size_t(k)];
      const Vec3 move = (1 - std::abs(k - at) / (kSpread + 1.0)) * back, normal = slice.axes.col(2);
      slice.center += move - normal * normal.dot(move);
    }
  }
  return bent;
}

}  // namespace

int straighten_strips(std::span<const Muscle> muscles, std::span<const Muscle> reference,
                      std::span<const int> partners, std::span<Ellipse> slices) {
  const std::vector<std::size_t> begin = slice_begins(muscles);
  std::atomic<int> bent = 0;
  tbb::parallel_for(std::size_t{0}, muscles.size(), [&](std::size_t m) {
    if (partners[m] >= 0 || lies_in_fat(muscles[m]) || m >= reference.size() ||
        !same_sections(muscles[m], reference[m]))
      return;
    std::size_t first = begin[m];
    for (std::size_t s = 0; s < muscles[m].strips.size(); ++s) {
      const Strip& strip = muscles[m].strips[s];
      const std::size_t n = strip.slices.size();
      if (n >= 4) bent += straighten(strip, reference[m].strips[s], slices.subspan(first, n));
      first += n;
    }
  });
  return bent;
}

}  // namespace ecorche::inline v1
