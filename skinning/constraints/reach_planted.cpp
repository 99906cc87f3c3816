#include "skinning/constraints/reach_planted.h"

#include <algorithm>
#include <cstddef>
#include <functional>

#include "skinning/constraints/contact_spans.h"
#include "skinning/constraints/smooth_above.h"
#include "skinning/constraints/temporal_smoothing.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kEase = 0.2;      // s; of the pelvis
constexpr double kFollow = 0.4;    // of what feet are lowered by, the pelvis goes with them
constexpr double kFree = 0.3;      // weight of a frame in which nothing stands
constexpr double kRising = 0.05;   // s to either side of a heel's rise
constexpr double kBending = 0.10;  // s; of that over an ankle that bends no further
constexpr double kFalling = 0.10;  // s; it fades out around a ball's stance

std::vector<double> pelvis_rise(const std::array<std::vector<LegReach>, 2>& legs, double fps) {
  std::vector<WantedValue> wanted;
  bool folded = false;
  for (std::size_t f = 0; f < legs[0].size(); ++f) {
    folded |= legs[0][f].folded > 0 || legs[1][f].folded > 0;
    wanted.push_back({0, 1, std::max(legs[0][f].folded, legs[1][f].folded)});
  }
  if (!folded) return std::vector<double>(wanted.size(), 0.0);
  return smooth_above(wanted, fps, kEase);
}

std::vector<double> pelvis_drop(const std::array<std::vector<LegReach>, 2>& legs,
                                const std::vector<double>& rise, double fps) {
  std::vector<WantedValue> wanted(legs[0].size(), {0, kFree});
  for (std::size_t f = 0; f < wanted.size(); ++f) {
    double low = 0;
    int standing = 0;
    for (const auto& leg : legs) {
      if (!leg[f].heel && !leg[f].ball) continue;
      wanted[f].least = std::max(wanted[f].least, leg[f].raised + rise[f]);
      low += leg[f].low;
      ++standing;
    }
    if (standing > 0)
      wanted[f].value = std::max(0.0, kFollow * low / standing), wanted[f].weight = 1;
  }
  std::vector<double> out = smooth_above(wanted, fps, kEase);
  for (std::size_t f = 0; f < out.size(); ++f) out[f] -= rise[f];
  return out;
}

std::vector<double> heel_rise(const std::vector<LegReach>& leg, const std::vector<double>& sunk,
                              double fps) {
  const std::size_t count = leg.size();
  std::vector<double> out(count, 0.0);
  for (std::size_t f = 0; f < count; ++f)
    if (leg[f].most > 0 && leg[f].flat > sunk[f])
      out[f] = leg[f].most *
               std::min(1.0, (leg[f].flat - sunk[f]) / std::max(1e-9, leg[f].flat - leg[f].raised));
  std::vector<double> bent;
  for (const LegReach& one : leg) bent.push_back(one.bent);
  const auto is_zero = [](double one) { return one == 0; };
  if (std::ranges::all_of(out, is_zero) && std::ranges::all_of(bent, is_zero)) return out;
  smooth_maximum(std::max(1, int(std::lround(kRising * fps))), out, std::greater<>());
  smooth_maximum(std::max(1, int(std::lround(kBending * fps))), bent, std::greater<>());
  std::vector<Interval> stances;
  std::vector<std::array<double, 2>> edges;
  for (std::size_t f = 0; f < count; ++f) {
    if (!leg[f].ball) continue;
    out[f] = std::max(std::min(out[f], leg[f].most), bent[f]);
    if (stances.empty() || stances.back().end != int(f))
      stances.push_back({int(f), int(f)}), edges.push_back({out[f], 0});
    stances.back().end = int(f) + 1;
    edges.back()[1] = out[f];
  }
  fade_out(stances, edges, out, kFalling * fps, 0.0,
           [](double rest, double edge, double share) { return rest + share * edge; });
  return out;
}

}  // namespace

ReachPlan plan_reach(const std::array<std::vector<LegReach>, 2>& legs, double fps) {
  ReachPlan out{pelvis_drop(legs, pelvis_rise(legs, fps), fps), {}};
  for (std::size_t s = 0; s < 2; ++s) out.rise[s] = heel_rise(legs[s], out.sunk, fps);
  return out;
}

}  // namespace ecorche::inline v1
