// Errors over any number of frames. Private to the room.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "skinning/bake/baked_rig.h"

namespace ecorche::inline v1 {

// Errors in ten thousand bins, so that percentiles of any number of frames need no memory.
class Errors {
 public:
  explicit Errors(double bin) : bin_(bin) {}
  void add(double d) {
    ++count_;
    sum_ += d;
    squares_ += d * d;
    max_ = std::max(max_, d);
    ++bins_[std::min(std::size_t(d / bin_), bins_.size() - 1)];
  }
  double mean() const { return count_ == 0 ? 0 : sum_ / double(count_); }
  double rms() const { return count_ == 0 ? 0 : std::sqrt(squares_ / double(count_)); }
  double max() const { return max_; }
  double p95() const {
    std::size_t below = 0, bin = 0;
    while (bin + 1 < bins_.size() && (below += bins_[bin]) < std::size_t(0.95 * double(count_)))
      ++bin;
    return std::min(bin_ * double(bin + 1), max_);
  }

 private:
  double bin_;
  std::vector<std::size_t> bins_ = std::vector<std::size_t>(10000, 0);
  std::size_t count_ = 0;
  double sum_ = 0, squares_ = 0, max_ = 0;
};

struct BakeErrors {
  Errors distances{1e-5}, angles{0.02};
  void add(const Eigen::VectorXd& m, const Eigen::VectorXd& degrees) {
    for (const double d : m) distances.add(d);
    for (const double a : degrees) angles.add(a);
  }
  BakeError summary(int frames) const {
    return {frames,          distances.mean(), distances.rms(), distances.p95(),
            distances.max(), angles.rms(),     angles.p95()};
  }
};

}  // namespace ecorche::inline v1
