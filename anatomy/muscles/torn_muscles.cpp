#include "anatomy/muscles/torn_muscles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <unordered_map>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/surface_reference.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kNeedleAtRest = 0.008;  // m
// From here on a muscle counts as torn. Set by looking (docs/check.md): below, what shows are
// dents, ridges and blunt edges.
struct TornFrom {
  int raised = 0;
  double worst = 0;  // m
};
constexpr TornFrom kManyRaised{20, 0.015}, kFarRaised{3, 0.025};

constexpr double kKinkReach = 0.03;  // m, of a chord to both sides
constexpr double kKinked = 0.02;     // m off the chord; less: a strip that goes round a bone

// The point of a line of centres at a length. `lengths`: #slices.
Vec3 point_at(std::span<const Ellipse> slices, const std::vector<double>& lengths, double length) {
  const auto after = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, length);
  const auto k = std::size_t(after - lengths.begin());
  const double t = (length - lengths[k - 1]) / std::max(lengths[k] - lengths[k - 1], 1e-9);
  return slices[k - 1].center + t * (slices[k].center - slices[k - 1].center);
}

// How far each section's centre lies off the chord over the strip's part about it; -1 near its
// ends. The part is measured along the action line: along the centres a kink would hide itself.
std::vector<double> off_chords(const Strip& strip, double reach) {
  const std::vector<Ellipse> slices = rest_slices(strip);
  std::vector<double> lengths(slices.size(), 0.0), out(slices.size(), -1.0);
  for (std::size_t k = 0; k < slices.size(); ++k)
    lengths[k] = strip.slices[k].s * strip.rest_length;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    if (lengths[k] - reach < lengths.front() || lengths[k] + reach > lengths.back()) continue;
    const Vec3 from = point_at(slices, lengths, lengths[k] - reach),
               to = point_at(slices, lengths, lengths[k] + reach);
    const Vec3 along = (to - from).stableNormalized(), off = slices[k].center - from;
    out[k] = (off - along * along.dot(off)).norm();
  }
  return out;
}

double measure_kink(const Muscle& muscle, const Muscle& reference) {
  double out = 0;
  for (std::size_t s = 0; s < muscle.strips.size(); ++s) {
    const Strip &now = muscle.strips[s], &then = reference.strips[s];
    const double scale = now.rest_length / std::max(then.rest_length, 1e-6);
    const std::vector<double> is = off_chords(now, kKinkReach),
                              was = off_chords(then, kKinkReach / scale);
    for (std::size_t k = 0; k < is.size(); ++k)
      if (is[k] >= 0 && was[k] >= 0) out = std::max(out, is[k] - scale * was[k]);
  }
  return out;
}

MuscleTear measure_tear(const Muscle& muscle, const Muscle& reference) {
  MuscleTear out;
  const SurfaceReference then(reference);
  const DrawnMuscle now(muscle);
  if (!then.matches(now)) return out;
  out.known = true;
  out.kink = measure_kink(muscle, reference);
  const Standing beyond = then.standing_beyond(now);
  for (std::size_t v = 0; v < beyond.off.size(); ++v) {
    const double raised = std::abs(beyond.out[v]);
    out.needles += beyond.off[v] > kNeedleAtRest;
    out.raised += raised > kNeedleAtRest;
    out.needle = std::max(out.needle, raised);
  }
  return out;
}

}  // namespace

std::vector<MuscleTear> measure_tears(const std::vector<Muscle>& muscles,
                                      const std::vector<Muscle>& reference) {
  std::unordered_map<std::string_view, const Muscle*> by_name;
  for (const Muscle& muscle : reference) by_name[muscle.name] = &muscle;
  std::vector<MuscleTear> out(muscles.size());
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    const auto found = by_name.find(muscles[m].name);
    if (found == by_name.end() || muscles[m].strips.empty() ||
        !same_sections(muscles[m], *found->second))
      continue;
    out[m] = measure_tear(muscles[m], *found->second);
  }
  return out;
}

bool is_torn(const MuscleTear& tear) {
  return tear.kink >= kKinked ||
         std::ranges::any_of(std::array{kManyRaised, kFarRaised}, [&](const TornFrom& from) {
           return tear.raised >= from.raised && tear.needle >= from.worst;
         });
}

std::vector<int> torn_muscles(const std::vector<MuscleTear>& tears) {
  std::vector<int> out;
  for (std::size_t m = 0; m < tears.size(); ++m)
    if (is_torn(tears[m])) out.push_back(int(m));
  const auto worst = [&](int m) { return std::max(tears[m].needle, tears[m].kink); };
  std::ranges::stable_sort(out, [&](int a, int b) { return worst(a) > worst(b); });
  return out;
}

}  // namespace ecorche::inline v1
