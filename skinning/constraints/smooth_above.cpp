#include "skinning/constraints/smooth_above.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "anatomy/compute/banded_system.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kRounds = 40;
constexpr double kBelow = 2e-6;  // what is less below is let be
constexpr double kHold = 1e7;    // stiffness that holds a sample, times the bending's

// Holds the worst sample of every span that is below. Whether there is any.
bool hold_worst(const std::vector<WantedValue>& wanted, const std::vector<double>& values,
                std::vector<char>& held) {
  bool any = false;
  const auto below = [&](std::size_t f) { return wanted[f].least - values[f]; };
  for (std::size_t f = 0; f < values.size(); ++f) {
    if (below(f) <= kBelow) continue;
    std::size_t worst = f;
    for (; f < values.size() && below(f) > kBelow; ++f)
      if (below(f) > below(worst)) worst = f;
    held[worst] = 1, any = true;
  }
  return any;
}

}  // namespace

std::vector<double> smooth_above(const std::vector<WantedValue>& wanted, double fps, double ease) {
  const std::size_t count = wanted.size();
  const double stiff = std::pow(ease * fps, 4);  // against a weight of 1
  std::vector<char> held(count, 0);
  std::vector<double> out;
  for (int round = 0; round < kRounds; ++round) {
    BandedSystem<2, double> system(int(count), 0.0);
    for (int f = 1; f + 1 < int(count); ++f)
      system.add<3>({f - 1, f, f + 1}, {1, -2, 1}, 0.0, stiff);
    for (int f = 0; f < int(count); ++f) {
      const WantedValue& here = wanted[std::size_t(f)];
      system.add<1>({f}, {1}, here.value, here.weight);
      if (held[std::size_t(f)]) system.add<1>({f}, {1}, here.least, kHold * stiff);
    }
    out = system.solve();
    bool changed = false;
    // A sample that is held stays below by its force over the stiffness.
    for (std::size_t f = 0; f < count; ++f)
      if (held[f] && out[f] > wanted[f].least) held[f] = 0, changed = true;
    if (!hold_worst(wanted, out, held) && !changed) break;
  }
  for (std::size_t f = 0; f < count; ++f) out[f] = std::max(out[f], wanted[f].least);
  return out;
}

}  // namespace ecorche::inline v1
