#include "anatomy/muscles/torn_muscles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <unordered_map>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/strip_kinks.h"
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

constexpr double kKinked = 0.02;  // m off the chord; less: a strip that goes round a bone

double measure_kink(const Muscle& muscle, const Muscle& reference) {
  double out = 0;
  for (std::size_t s = 0; s < muscle.strips.size(); ++s) {
    const Strip& strip = muscle.strips[s];
    for (const double kink : kinks_beyond(strip, rest_slices(strip), reference.strips[s]))
      out = std::max(out, kink);
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
