#include "anatomy/muscles/belly_length.h"

#include <algorithm>
#include <cmath>

#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {

std::vector<BellyRestLength> belly_rest_lengths(const Anatomy& anatomy) {
  std::vector<BellyRestLength> out;
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) {
      BellyRestLength& rest = out.emplace_back();
      rest.rest = line_length(strip.path);
      const double begin = std::clamp(strip.belly_begin, 0.0, 1.0),
                   end = std::clamp(strip.belly_end, 0.0, 1.0);
      rest.belly_rest = (end > begin + 1e-6 ? end - begin : 1) * rest.rest;
      rest.compliance = TendonCompliance({muscle.fibre_length, muscle.pennation, rest.rest});
    }
  return out;
}

double belly_length(const BellyRestLength& rest_length, double length, double activation) {
  const double tendon_rest = rest_length.rest - rest_length.belly_rest;
  const double stretch = std::max(
      (length - rest_length.rest) / (rest_length.belly_rest + kTendonStretchRatio * tendon_rest),
      -0.9);
  const double belly = rest_length.belly_rest * (1 + stretch);
  if (!(activation > 0)) return belly;
  const double shortening = rest_length.compliance.at(length, std::sqrt(std::min(activation, 1.0)));
  return belly - std::min({shortening, kTendonLimit * tendon_rest, kShortLimit * belly});
}

}  // namespace ecorche::inline v1
