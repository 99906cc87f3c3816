#include "anatomy/muscles/belly_length.h"

#include <algorithm>
#include <cmath>

#include "anatomy/muscles/action_line.h"
#include "anatomy/posing/activation_bulge.h"

namespace ecorche {

std::vector<BellyShare> belly_shares(const Anatomy& anatomy) {
  std::vector<BellyShare> out;
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) {
      BellyShare& share = out.emplace_back();
      share.rest = line_length(strip.path);
      const double begin = std::clamp(strip.belly_begin, 0.0, 1.0),
                   end = std::clamp(strip.belly_end, 0.0, 1.0);
      share.belly_rest = (end > begin + 1e-6 ? end - begin : 1) * share.rest;
      share.give = TendonGive({muscle.fibre_length, muscle.pennation, share.rest});
    }
  return out;
}

double belly_length(const BellyShare& share, double length, double activation) {
  const double tendon_rest = share.rest - share.belly_rest;
  const double stretch =
      std::max((length - share.rest) / (share.belly_rest + kTendonGive * tendon_rest), -0.9);
  const double belly = share.belly_rest * (1 + stretch);
  if (!(activation > 0)) return belly;
  const double gives = share.give.at(length, std::sqrt(std::min(activation, 1.0)));
  return belly - std::min({gives, kTendonLimit * tendon_rest, kShortLimit * belly});
}

}  // namespace ecorche
