// Least squares over unknowns in a row, of which each term takes a few that lie near each other.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace ecorche::inline v1 {

// Symmetric and positive definite, by its lower band. Value: of an unknown, a number or a vector.
template <int kBand, typename Value>
class BandedSystem {
 public:
  BandedSystem(int size, const Value& zero) : rows_(std::size_t(size)), right_(rows_.size(), zero) {
    for (auto& row : rows_) row.fill(0);
  }

  // weight |sum of factors x - wanted|^2. Precondition: unknowns at most kBand apart.
  template <std::size_t kCount>
  void add(const std::array<int, kCount>& at, const std::array<double, kCount>& factors,
           const Value& wanted, double weight) {
    for (std::size_t a = 0; a < kCount; ++a) {
      right_[at[a]] += weight * factors[a] * wanted;
      for (std::size_t b = 0; b < kCount; ++b)
        if (at[b] <= at[a]) rows_[at[a]][at[a] - at[b]] += weight * factors[a] * factors[b];
    }
  }

  // The unknowns, by L D L', row by row: a row holds L D until the row is whole. Called once.
  std::vector<Value> solve() {
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
  std::vector<Value> right_;
};

}  // namespace ecorche::inline v1
