#include "morph/dilation/slim_muscles.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"
#include "morph/dilation/packed_sections.h"

namespace ecorche::inline v1 {
namespace {

// Fraction of the way from a section's centre to its outer side: the point that it shrinks about.
// Larger: more of the gap lies on the inner side; smaller: superficial muscles leave the layer.
constexpr double kTowardsSkin = 0.6;
// Least factor of a half axis. Larger: the total volume is not reached; smaller: thin bellies.
constexpr double kLeastSlimMuscles = 0.7;
constexpr double kMostEffort = 6;

// Where the outline of a section ends in the direction of its thickness, which points to the skin.
double outer_side(const Ellipse& slice) {
  double most = 0;
  for (std::size_t i = 0; i < std::size_t(kOutlinePoints); ++i)
    most = std::max(most, double(slice.outline[i]) * outline_directions()[i].y());
  return most * slice.radii.y();
}

// A section of which `share` of its half axes is left; a sheet's strips stay as wide.
Ellipse slimmed(Ellipse slice, double share, bool sheet, bool outer) {
  const double across = sheet ? share * share : share;
  if (outer) slice.center += (1 - across) * kTowardsSkin * outer_side(slice) * slice.axes.col(1);
  slice.radii.y() *= across;
  if (!sheet) slice.radii.x() *= share;
  return slice;
}

class Slimmer {
 public:
  Slimmer(std::vector<Muscle>& muscles, std::span<Ellipse> slices, std::span<const double> wanted,
          std::span<const int> partners, double total)
      : muscles_(muscles),
        slices_(slices),
        before_(slices.begin(), slices.end()),
        partners_(partners),
        begin_(slice_begins(muscles)),
        filled_(muscles.size()),
        own_(muscles.size()) {
    double sum = 0;
    for (std::size_t m = 0; m < muscles.size(); ++m) sum += weighed(m) ? wanted[m] : 0;
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      filled_[m] = volume(m);
      own_[m] = sum > 0 ? wanted[m] * total / sum : 0;
    }
  }

  // With more effort muscles come nearer to their own volumes, beyond 1 all below them.
  double shrink(double effort) {
    tbb::parallel_for(std::size_t{0}, muscles_.size(), [&](std::size_t m) {
      if (!weighed(m)) return;
      const std::size_t as = partners_[m] >= 0 ? std::size_t(partners_[m]) : m;
      const double beyond = filled_[as] > own_[as] && filled_[as] > 0 ? own_[as] / filled_[as] : 1;
      constexpr double kFurther = 0.8;
      const double share =
          std::pow(beyond, std::min(effort, 1.0)) * std::pow(kFurther, std::max(effort - 1, 0.0));
      set(m, std::max(kLeastSlimMuscles, std::sqrt(share)));
    });
    return sum();
  }

  double sum() const {
    double all = 0;
    for (std::size_t m = 0; m < muscles_.size(); ++m) all += weighed(m) ? volume(m) : 0;
    return all;
  }

  void finish() {
    for (std::size_t m = 0; m < muscles_.size(); ++m) {
      std::size_t at = begin_[m];
      for (Strip& strip : muscles_[m].strips) {
        const std::size_t n = strip.slices.size();
        if (n >= 2) set_slices(strip, slices_.subspan(at, n));
        at += n;
      }
    }
  }

 private:
  // Whole bodies' muscle is measured without the muscles of the skin.
  bool weighed(std::size_t m) const { return !lies_in_fat(muscles_[m]); }

  void set(std::size_t m, double share) {
    const Muscle& muscle = muscles_[m];
    const bool sheet = muscle.sheet && muscle.strips.size() > 1,
               outer = muscle.layer == "superficial";
    std::size_t k = begin_[m];
    for (const Strip& strip : muscle.strips)
      for (const Slice& slice : strip.slices) {
        const double left = 1 - (1 - share) * belly_weight(strip, slice.s);
        slices_[k] = slimmed(before_[k], left, sheet || strip.raphe > 0, outer);
        ++k;
      }
  }

  double volume(std::size_t m) const {
    double all = 0;
    std::size_t at = begin_[m];
    for (const Strip& strip : muscles_[m].strips) {
      const std::size_t n = strip.slices.size();
      if (n >= 2) all += tube_volume(slices_.subspan(at, n));
      at += n;
    }
    return all;
  }

  std::vector<Muscle>& muscles_;
  std::span<Ellipse> slices_;
  std::vector<Ellipse> before_;
  std::span<const int> partners_;
  std::vector<std::size_t> begin_;    // #muscles + 1, slices
  std::vector<double> filled_, own_;  // #muscles, m^3
};

}  // namespace

double slim_muscles(std::vector<Muscle>& muscles, std::span<Ellipse> slices,
                    std::span<const double> wanted, std::span<const int> partners, double total) {
  Slimmer slimmer(muscles, slices, wanted, partners, total);
  double now = slimmer.sum();
  if (now <= total) return now;
  double low = 0, high = kMostEffort;
  constexpr int kHalvings = 14;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    now = slimmer.shrink(middle);
    (now > total ? low : high) = middle;
  }
  now = slimmer.shrink(high);
  slimmer.finish();
  return now;
}

}  // namespace ecorche::inline v1
