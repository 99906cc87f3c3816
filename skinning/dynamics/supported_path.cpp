#include "skinning/dynamics/supported_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "anatomy/compute/banded_system.h"
#include "skinning/dynamics/joint_loads.h"

namespace ecorche::inline v1 {
namespace {

// Places and forces come in turns: c0 u0 c1 u1 ..; rows of three frames reach over five unknowns.
constexpr int kBand = 4;
// What an acceleration costs that no contact gives, over what a distance from the seen path costs:
// 1 mm for 0.3 m/s^2.
constexpr double kUnsupported = 1e-5;

}  // namespace

SupportedPath supported_path(const std::vector<Vec3>& seen, const std::vector<double>& contact,
                             double fps, double cutoff) {
  const int n = int(seen.size());
  if (n < 3 || contact.size() != seen.size() || !(fps > 0) || !(cutoff > 0))
    throw std::invalid_argument("supported_path: frames, contacts or rates are missing");
  const double rate = fps * fps, smooth = std::pow(2 * std::numbers::pi * cutoff, -8),
               tiny = 1e-3 * smooth;
  const Vec3 fall(0, -kGravity, 0), stand(0, kGravity, 0), none = Vec3::Zero();
  BandedSystem<kBand, Vec3> system(2 * n, none);
  for (int f = 0; f < n; ++f) {
    system.add<1>({2 * f}, {1}, seen[f], 1);
    system.add<1>({2 * f + 1}, {1}, stand, tiny);  // of what no row holds: standing
    if (f == 0 || f == n - 1) continue;
    system.add<4>({2 * f - 2, 2 * f, 2 * f + 2, 2 * f + 1}, {rate, -2 * rate, rate, -contact[f]},
                  fall, kUnsupported);
    system.add<3>({2 * f - 1, 2 * f + 1, 2 * f + 3}, {rate, -2 * rate, rate}, none, smooth);
  }
  const std::vector<Vec3> found = system.solve();
  SupportedPath out;
  for (int f = 0; f < n; ++f) {
    out.place.push_back(found[2 * f]);
    out.acceleration.push_back(fall + contact[f] * found[2 * f + 1]);
    out.moved = std::max(out.moved, (out.place.back() - seen[f]).norm());
  }
  return out;
}

}  // namespace ecorche::inline v1
