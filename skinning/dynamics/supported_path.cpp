#include "skinning/dynamics/supported_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "skinning/dynamics/joint_loads.h"

namespace ecorche::inline v1 {
namespace {

// Places and forces come in turns: c0 u0 c1 u1 ..; rows of three frames reach over five unknowns.
constexpr int kBand = 4;
// What an acceleration costs that no contact gives, over what a distance from the seen path costs:
// 1 mm for 0.3 m/s^2.
constexpr double kUnsupported = 1e-5;

// Symmetric and positive definite, by its lower band; three right-hand sides.
class BandedSystem {
 public:
  explicit BandedSystem(int size) : rows_(size), right_(size, Vec3::Zero()) {
    for (auto& row : rows_) row.fill(0);
  }

  // weight |sum of factors x - wanted|^2
  template <std::size_t kCount>
  void add(const std::array<int, kCount>& at, const std::array<double, kCount>& factors,
           const Vec3& wanted, double weight) {
    for (std::size_t a = 0; a < kCount; ++a) {
      right_[at[a]] += weight * factors[a] * wanted;
      for (std::size_t b = 0; b < kCount; ++b)
        if (at[b] <= at[a]) rows_[at[a]][at[a] - at[b]] += weight * factors[a] * factors[b];
    }
  }

  // L D L', row by row: a row holds L D until the row is whole.
  std::vector<Vec3> solve() {
    const int n = int(rows_.size());
    for (int i = 0; i < n; ++i) {
      for (int j = std::max(0, i - kBand); j < i; ++j)
        for (int k = std::max({0, i - kBand, j - kBand}); k < j; ++k)
          rows_[i][i - j] -= rows_[i][i - k] * rows_[j][j - k];
      for (int j = std::max(0, i - kBand); j < i; ++j) rows_[i][i - j] /= rows_[j][0];
      for (int j = std::max(0, i - kBand); j < i; ++j) {
        rows_[i][0] -= rows_[i][i - j] * rows_[i][i - j] * rows_[j][0];
        right_[i] -= rows_[i][i - j] * right_[j];
      }
    }
    for (int i = 0; i < n; ++i) right_[i] /= rows_[i][0];
    for (int i = n - 1; i >= 0; --i)
      for (int j = std::max(0, i - kBand); j < i; ++j) right_[j] -= rows_[i][i - j] * right_[i];
    return right_;
  }

 private:
  std::vector<std::array<double, kBand + 1>> rows_;  // [i][d]: of row i and column i - d
  std::vector<Vec3> right_;
};

}  // namespace

SupportedPath supported_path(const std::vector<Vec3>& seen, const std::vector<double>& contact,
                             double fps, double cutoff) {
  const int n = int(seen.size());
  if (n < 3 || contact.size() != seen.size() || !(fps > 0) || !(cutoff > 0))
    throw std::invalid_argument("supported_path: frames, contacts or rates are missing");
  const double rate = fps * fps, smooth = std::pow(2 * std::numbers::pi * cutoff, -8),
               tiny = 1e-3 * smooth;
  const Vec3 fall(0, -kGravity, 0), stand(0, kGravity, 0), none = Vec3::Zero();
  BandedSystem system(2 * n);
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
