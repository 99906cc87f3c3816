#include "anatomy/muscles/tendon_compliance.h"

#include <algorithm>
#include <cmath>

#include "anatomy/muscles/force_curves.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kShortest = 0.3, kLongest = 1.7;  // fibre lengths that count, over the optimal one

// In units of the optimal fibre length.
struct Balance {
  double rise;    // of the fibre across the path
  double tendon;  // slack length
  double path;
  double activation;

  // Pull of the fibre less that of the tendon, the fibre being m long along the path. Falls through
  // zero where they balance.
  double operator()(double m) const {
    const double l = std::sqrt(m * m + rise * rise);
    return (activation * active_force(l) + passive_force(l)) * m / l -
           tendon_force((path - m) / tendon - 1);
  }
};

// From a length at which the fibre pulls harder down to the first balance: where an activation that
// sets in slowly comes to rest.
double shorten(const Balance& balance, double from) {
  constexpr double kStep = 0.04, kClose = 1e-7;
  const double least = std::min(from, 0.05);
  double high = from, f_high = balance(high);
  if (f_high <= 0) return from;
  double low = high, f_low = f_high;
  while (f_low > 0 && low > least) {
    high = low;
    f_high = f_low;
    low = std::max(least, low - kStep);
    f_low = balance(low);
  }
  if (f_low > 0) return low;
  // the end that stayed last time: its value is halved when it stays again (false position,
  // Illinois)
  int kept = 0;
  for (int i = 0; i < 60 && high - low > kClose; ++i) {
    const double at = low + (high - low) * f_low / (f_low - f_high), f = balance(at);
    if (std::abs(f) < kClose) return at;
    if (f > 0) {
      high = at;
      f_high = f;
      if (kept == -1) f_low *= 0.5;
      kept = -1;
    } else {
      low = at;
      f_low = f;
      if (kept == 1) f_high *= 0.5;
      kept = 1;
    }
  }
  return 0.5 * (low + high);
}

// The optimal fibre and the slack tendon.
struct Lengths {
  double fibre, tendon;

  explicit Lengths(const MuscleTendon& muscle) {
    const double along = std::cos(muscle.pennation);
    fibre = std::min(muscle.fibre, 0.95 * muscle.path / along);
    tendon = muscle.path - fibre * along;
  }
};

bool has_fibres(const MuscleTendon& muscle) {
  return muscle.fibre > 0 && muscle.path > 0 && std::cos(muscle.pennation) > 0.1;
}

}  // namespace

double isometric_shortening(const MuscleTendon& muscle, double path, double activation) {
  if (!has_fibres(muscle) || !(activation > 0) || !(path > 0)) return 0;
  const Lengths lengths(muscle);
  Balance balance{std::sin(muscle.pennation), lengths.tendon / lengths.fibre, path / lengths.fibre,
                  0};
  if (balance.path - balance.tendon < 0.05) return 0;
  const double relaxed = shorten(balance, balance.path - balance.tendon);
  balance.activation = std::min(activation, 1.0);
  return lengths.fibre * (relaxed - shorten(balance, relaxed));
}

TendonCompliance::TendonCompliance(const MuscleTendon& muscle) {
  if (!has_fibres(muscle)) return;
  const Lengths lengths(muscle);
  first_ = lengths.tendon + kShortest * lengths.fibre;
  per_step_ = (kLengths - 1) / ((kLongest - kShortest) * lengths.fibre);
  for (int i = 0; i < kLengths; ++i) {
    Balance balance{std::sin(muscle.pennation), lengths.tendon / lengths.fibre,
                    (first_ + i / per_step_) / lengths.fibre, 0};
    const double relaxed = shorten(balance, balance.path - balance.tendon);
    double at = relaxed;
    for (int j = 1; j < kActivations;
         ++j) {  // more activation shortens further from the balance of less
      balance.activation = double(j * j) / ((kActivations - 1) * (kActivations - 1));
      at = shorten(balance, at);
      shortening_[unsigned(i * kActivations + j)] = float(lengths.fibre * (relaxed - at));
    }
  }
}

}  // namespace ecorche::inline v1
