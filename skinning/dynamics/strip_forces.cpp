#include "skinning/dynamics/strip_forces.h"

#include <algorithm>
#include <cmath>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/force_curves.h"
#include "anatomy/muscles/muscle_force.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMostFibre = 0.95;    // of the path: fibres at rest leave room for a tendon
constexpr double kLeastTendon = 0.02;  // of the path
constexpr double kShortest = 0.3, kLongest = 1.6;  // fibres, over their optimal length
// Fibres are taut from here on. That they are optimal at rest is a convention; were they taut from
// there on, a knee of 60 degrees would be held by 50 N m, where people's is by a few (Riener &
// Edrich 1999, 10.1016/S0021-9290(99)00090-7).
constexpr double kTaut = 1.3;

StripForce strip_force(const Muscle& muscle, const Strip& strip, double share) {
  StripForce out;
  out.share = share;
  if (!(muscle.fibre_length > 0)) return out;  // no fibres that are known
  const double path = line_length(strip.path);
  out.largest =
      share * (muscle.max_force > 0 ? muscle.max_force
                                    : isometric_force(muscle.volume, muscle.fibre_length));
  out.rise = std::sin(muscle.pennation);
  out.fibre = muscle.fibre_length;
  if (muscle.max_force > 0 && muscle.tendon_slack > 0) {
    out.slack = muscle.tendon_slack;
  } else {
    out.fibre = std::min(out.fibre, kMostFibre * path);
    out.slack = std::max(kLeastTendon * path, path - out.fibre * std::cos(muscle.pennation));
  }
  return out;
}

}  // namespace

std::vector<StripForce> strip_forces(const Anatomy& anatomy) {
  std::vector<StripForce> out;
  for (std::size_t m = 0; m < anatomy.muscles.size(); ++m) {
    const Muscle& muscle = anatomy.muscles[m];
    std::vector<double> volumes;
    double total = 0;
    for (const Strip& strip : muscle.strips) {
      volumes.push_back(strip.slices.size() >= 2 ? tube_volume(rest_slices(strip)) : 0);
      total += volumes.back();
    }
    for (std::size_t k = 0; k < muscle.strips.size(); ++k) {
      const double share = total > 0 ? volumes[k] / total : 1 / double(muscle.strips.size());
      out.push_back(strip_force(muscle, muscle.strips[k], share));
      out.back().muscle = int(m);
    }
  }
  return out;
}

double fibre_along(const StripForce& strip, double path, double strain) {
  return std::clamp((path - strip.slack * (1 + strain)) / strip.fibre, kShortest, kLongest);
}

Pull pull_of(const StripForce& strip, double along, double speed) {
  const double l = std::hypot(along, strip.rise), cosine = along / l;
  // the fibre itself lengthens by cos(pennation) of what it lengthens along the path
  return {active_force(l) * velocity_force(speed * cosine / kFastestFibre) * cosine,
          passive_force(l - kTaut + 1) * cosine};
}

}  // namespace ecorche::inline v1
