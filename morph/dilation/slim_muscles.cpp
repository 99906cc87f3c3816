#include "morph/dilation/slim_muscles.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"
#include "morph/dilation/packed_sections.h"

namespace ecorche::inline v1 {
namespace {

// Fraction of the way from a section's centre to its outer side: the point that it shrinks about.
// Larger: more of the gap lies on the inner side; smaller: superficial muscles leave the layer.
constexpr double kTowardsSkin = 0.9;
// How much more of what it loses is thickness towards the skin than width, 0 .. 1. Larger: flat
// bellies; smaller: gaps between neighbours.
constexpr double kFlatter = 0.5;
constexpr int kOutwardRays = 16;           // a section
constexpr double kFarthestOutward = 0.25;  // m
// Least factor of a half axis. Larger: the total volume is not reached; smaller: thin bellies.
constexpr double kLeastSlimMuscles = 0.7;
// The same of the belly's wall, behind which lies what is not drawn. Larger: walls of big bellies
// several times as thick as in life.
constexpr double kLeastSlimWall = 0.4;
constexpr double kMostEffort = 6;

// The way out of a section, in its plane: to where the skin is nearest; nought where it is as near
// on all sides.
Vec3 way_out(const Ellipse& slice, const SkinRays& skin) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < kOutwardRays; ++i) {
    const double angle = 2 * std::numbers::pi * i / kOutwardRays;
    const Vec3 direction =
        std::cos(angle) * slice.axes.col(0) + std::sin(angle) * slice.axes.col(1);
    const RayHit hit = skin.first_hit(slice.center, direction, kFarthestOutward);
    if (hit.triangle >= 0) sum += std::pow(rounded(double(hit.distance)) + 1e-3, -3) * direction;
  }
  return sum.stableNormalized();
}

// How far the outline of a section goes in a direction.
double extent(const Ellipse& slice, const Vec3& direction) {
  const Vec2 across(slice.radii.x() * direction.dot(slice.axes.col(0)),
                    slice.radii.y() * direction.dot(slice.axes.col(1)));
  double most = 0;
  for (std::size_t i = 0; i < std::size_t(kOutlinePoints); ++i)
    most = std::max(most, double(slice.outline[i]) * across.dot(outline_directions()[i]));
  return most;
}

// A section of which the square of `share` is left, of its area; a sheet's strips stay as wide.
Ellipse slimmed(Ellipse slice, double share, bool sheet, const Vec3& outwards) {
  const double before = extent(slice, outwards);
  const double along = outwards.dot(slice.axes.col(1)),
               thin = sheet                      ? 2
                      : outwards == Vec3::Zero() ? 1
                                                 : 1 + kFlatter * (2 * along * along - 1);
  slice.radii.y() *= std::pow(share, thin);
  slice.radii.x() *= std::pow(share, 2 - thin);
  slice.center += kTowardsSkin * (before - extent(slice, outwards)) * outwards;
  return slice;
}

class Slimmer {
 public:
  Slimmer(const std::vector<Muscle>& muscles, std::span<Ellipse> slices,
          std::span<const double> wanted, std::span<const int> partners, double total,
          const SkinRays& skin)
      : muscles_(muscles),
        slices_(slices),
        before_(slices.begin(), slices.end()),
        partners_(partners),
        begin_(slice_begins(muscles)),
        outwards_(slices.size(), Vec3::Zero()),
        filled_(muscles.size()),
        own_(muscles.size()) {
    double sum = 0;
    for (std::size_t m = 0; m < muscles.size(); ++m) sum += weighed(m) ? wanted[m] : 0;
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      filled_[m] = volume(m);
      own_[m] = sum > 0 ? wanted[m] * total / sum : 0;
    }
    tbb::parallel_for(std::size_t{0}, muscles.size(), [&](std::size_t m) {
      if (muscles[m].layer != "superficial" || !weighed(m)) return;
      for (std::size_t k = begin_[m]; k < begin_[m + 1]; ++k)
        outwards_[k] = way_out(before_[k], skin);
    });
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

  // The belly's wall to its own volume, whatever the others hold: its room goes on behind it.
  double shrink_wall() {
    tbb::parallel_for(std::size_t{0}, muscles_.size(), [&](std::size_t m) {
      if (!is_wall(muscles_[m]) || !(filled_[m] > own_[m])) return;
      set(m, std::max(kLeastSlimWall, std::sqrt(own_[m] / filled_[m])));
    });
    before_.assign(slices_.begin(), slices_.end());
    for (std::size_t m = 0; m < muscles_.size(); ++m) filled_[m] = volume(m);
    return sum();
  }

  double sum() const {
    double all = 0;
    for (std::size_t m = 0; m < muscles_.size(); ++m) all += weighed(m) ? volume(m) : 0;
    return all;
  }

 private:
  // Whole bodies' muscle is measured without the muscles of the skin.
  bool weighed(std::size_t m) const { return !lies_in_fat(muscles_[m]); }

  static bool is_wall(const Muscle& muscle) {
    return muscle.group == "trunk_abdomen" && muscle.layer == "superficial";
  }

  // Drawn as one sheet, or joined to its other side.
  bool is_sheet(std::size_t m) const {
    const Muscle& muscle = muscles_[m];
    return (muscle.sheet && muscle.strips.size() > 1) ||
           std::any_of(muscle.strips.begin(), muscle.strips.end(),
                       [](const Strip& strip) { return strip.raphe > 0; });
  }

  void set(std::size_t m, double share) {
    const Muscle& muscle = muscles_[m];
    const bool sheet = is_sheet(m);
    std::size_t k = begin_[m];
    for (const Strip& strip : muscle.strips)
      for (const Slice& slice : strip.slices) {
        const double left = 1 - (1 - share) * belly_weight(strip, slice.s);
        slices_[k] = slimmed(before_[k], left, sheet, outwards_[k]);
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

  const std::vector<Muscle>& muscles_;
  std::span<Ellipse> slices_;
  std::vector<Ellipse> before_;
  std::span<const int> partners_;
  std::vector<std::size_t> begin_;    // #muscles + 1, slices
  std::vector<Vec3> outwards_;        // #slices, of superficial muscles, unit or nought
  std::vector<double> filled_, own_;  // #muscles, m^3
};

}  // namespace

double slim_muscles(const std::vector<Muscle>& muscles, std::span<Ellipse> slices,
                    std::span<const double> wanted, std::span<const int> partners, double total,
                    const SkinRays& skin) {
  Slimmer slimmer(muscles, slices, wanted, partners, total, skin);
  double now = slimmer.shrink_wall();
  if (now <= total) return now;
  double low = 0, high = kMostEffort;
  constexpr int kHalvings = 14;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    now = slimmer.shrink(middle);
    (now > total ? low : high) = middle;
  }
  return slimmer.shrink(high);
}

}  // namespace ecorche::inline v1
