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
constexpr double kFalling = 0.10;  // s; it fades out around a ball's stance

std::vector<double> pelvis_drop(const std::array<std::vector<LegReach>, 2>& legs, double fps) {
  std::vector<WantedValue> wanted(legs[0].size(), {0, kFree});
  for (std::size_t f = 0; f < wanted.size(); ++f) {
    double low = 0;
    int standing = 0;
    for (const auto& leg : legs) {
      if (!leg[f].heel && !leg[f].ball) continue;
      wanted[f].least = std::max(wanted[f].least, leg[f].raised);
      low += leg[f].low;
      ++standing;
    }
    if (standing > 0)
      wanted[f].value = std::max(0.0, kFollow * low / standing), wanted[f].weight = 1;
  }
  return smooth_above(wanted, fps, kEase);
}

std::vector<double> heel_rise(const std::vector<LegReach>& leg, const std::vector<double>& sunk,
                              double fps) {
  const std::size_t count = leg.size();
  std::vector<double> out(count, 0.0);
  for (std::size_t f = 0; f < count; ++f)
    if (leg[f].most > 0 && leg[f].flat > sunk[f])
      out[f] = leg[f].most *
               std::min(1.0, (leg[f].flat - sunk[f]) / std::max(1e-9, leg[f].flat - leg[f].raised));
  if (std::ranges::all_of(out, [](double one) { return one == 0; })) return out;
  smooth_maximum(std::max(1, int(std::lround(kRising * fps))), out, std::greater<>());
  std::vector<Interval> stances;
  std::vector<std::array<double, 2>> edges;
  for (std::size_t f = 0; f < count; ++f) {
    if (!leg[f].ball) continue;
    out[f] = std::min(out[f], leg[f].most);
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
  ReachPlan out{pelvis_drop(legs, fps), {}};
  for (std::size_t s = 0; s < 2; ++s) out.rise[s] = heel_rise(legs[s], out.sunk, fps);
  return out;
}

}  // namespace ecorche::inline v1
