#include "morph/dilate.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/carry_muscles.h"
#include "anatomy/muscle_line.h"
#include "morph/flesh_field.h"
#include "morph/slice_room.h"

namespace ecorche {

namespace {

constexpr double kTwoPi = 6.283185307179586;

struct StripCount {
  long long rays = 0, misses = 0;
  int pulled_in = 0, pressed = 0, grown = 0;

  void add(const StripCount& o) {
    rays += o.rays;
    misses += o.misses;
    pulled_in += o.pulled_in;
    pressed += o.pressed;
    grown += o.grown;
  }
};

// --- paper ---------------------------------------------------------------------------------------------------------------------

// The factor of one muscle: the least (|O S| - layer) / |O E| of all rays. With the cut, a ray ends where even the thickest
// layer could not let it lower the factor; what it misses beyond cannot change the result.
double least_factor(const std::vector<std::vector<Ellipse>>& strips, const SkinRays& rays, const FatLayer& fat, double thickest,
                    const DilateOptions& options, StripCount& count) {
  double factor = std::numeric_limits<double>::infinity();
  for (const auto& slices : strips) {
    for (const Ellipse& slice : slices) {
      for (int k = 0; k < options.rays; ++k) {
        const double angle = kTwoPi * k / options.rays;
        const Vec3 to_edge = slice.radii.x() * std::cos(angle) * slice.axes.col(0) + slice.radii.y() * std::sin(angle) * slice.axes.col(1);
        const double edge = to_edge.norm();
        if (edge <= 0) continue;
        const double far = options.cut_rays ? factor * edge + thickest : std::numeric_limits<double>::infinity();
        const RayHit hit = rays.first_hit(slice.center, to_edge / edge, far);
        ++count.rays;
        if (hit.triangle < 0) {
          count.misses += !std::isfinite(far);
          continue;
        }
        factor = std::min(factor, std::max(0.0, static_cast<double>(hit.distance - fat.at(rays.mesh().F, hit))) / edge);
      }
    }
  }
  return std::isfinite(factor) ? factor : 1;
}

void dilate_paper(Muscle& muscle, const Muscle& original, const SkinRays& rays, const FatLayer& fat, double thickest,
                  const DilateOptions& options, StripCount& count, double& factor) {
  std::vector<std::vector<Ellipse>> strips;
  for (std::size_t s = 0; s < muscle.strips.size(); ++s) {
    Strip& strip = muscle.strips[s];
    const double length_scale = original.strips[s].rest_length > 0 ? strip.rest_length / original.strips[s].rest_length : 1;
    for (std::size_t k = 0; k < strip.slices.size(); ++k) {
      strip.slices[k].radii = options.alpha * length_scale * original.strips[s].slices[k].radii;
    }
    strips.push_back(rest_slices(strip));
  }
  factor = least_factor(strips, rays, fat, thickest, options, count);
  for (Strip& strip : muscle.strips) scale_radii(strip, Vec2::Constant(factor));
}

// --- ecorche -------------------------------------------------------------------------------------------------------------------

// 1 on the belly, fading to 0 within a tenth of the line on the tendons.
double belly_share(const Strip& strip, double s) {
  constexpr double kFade = 0.1;
  return std::clamp(1 - std::max(strip.belly_begin - s, s - strip.belly_end) / kFade, 0.0, 1.0);
}

// Shifts smoothed along the strip, never beyond the length of the first ones.
void smooth_shifts(std::vector<Vec2>& shifts) {
  const std::vector<Vec2> most = shifts;
  std::vector<Vec2> next = shifts;
  for (int round = 0; round < 8; ++round) {
    for (std::size_t k = 0; k < shifts.size(); ++k) {
      const Vec2 before = shifts[k > 0 ? k - 1 : k], after = shifts[k + 1 < shifts.size() ? k + 1 : k];
      next[k] = (before + 2 * shifts[k] + after) / 4;
      const double length = next[k].norm(), limit = most[k].norm();
      if (length > limit) next[k] *= limit / length;
    }
    shifts.swap(next);
  }
}

// A running mean of three along the strip, some times over; the ends stay.
template <class Value>
void smooth_along(std::vector<Value>& values, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    Value before = values.front();
    for (std::size_t k = 1; k + 1 < values.size(); ++k) {
      const Value here = values[k];
      values[k] = (before + 2 * here + values[k + 1]) / 4;
      before = here;
    }
  }
}

// The strip moved and stretched with the flesh around it.
void stretch_strip(Strip& strip, int muscle, const FleshField& flesh) {
  std::vector<Ellipse> slices = rest_slices(strip);
  std::vector<Vec3> shifts;
  std::vector<Vec2> scales;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const Ellipse& slice = slices[k];
    const FleshPull pull = flesh.at(slice.center, muscle);
    // Flesh that grows outwards also spreads sideways, at half the rate; pressed flesh keeps its width. Tendons do not grow.
    const double belly = belly_share(strip, strip.slices[k].s);
    const double stretch = pull.stretch > 1 ? 1 + belly * (pull.stretch - 1) : pull.stretch;
    const double sideways = stretch > 1 ? 1 + (stretch - 1) / 2 : 1;
    Vec2 scale;
    double half = 0;
    for (int axis = 0; axis < 2; ++axis) {
      const double along = std::pow(slice.axes.col(axis).dot(pull.outwards), 2);
      scale[axis] = along * stretch + (1 - along) * sideways;
      half += along * std::pow(scale[axis] * slice.radii[axis], 2);
    }
    const double most = std::max(0.0, pull.free - std::sqrt(half));
    shifts.push_back((pull.shift > 0 ? std::min(belly * pull.shift, most) : pull.shift) * pull.outwards);
    scales.push_back(scale);
  }
  smooth_along(shifts, 3);
  smooth_along(scales, 3);
  for (std::size_t k = 0; k < slices.size(); ++k) {
    slices[k].center += shifts[k];
    slices[k].radii = slices[k].radii.cwiseProduct(scales[k]);
  }
  set_slices(strip, slices);
}

StripCount dilate_strip(Strip& strip, bool grows, const SkinRays& rays, const FatLayer& fat, const DilateOptions& options) {
  StripCount count;
  std::vector<Ellipse> slices = rest_slices(strip);
  std::vector<std::vector<HalfPlane>> rooms(slices.size());
  std::vector<Section> sections(slices.size());
  std::vector<Vec2> shifts(slices.size(), Vec2::Zero());
  for (std::size_t k = 0; k < slices.size(); ++k) {
    sections[k].radii = slices[k].radii;
    const RoomCount room = find_room(slices[k], options.rays, rays, fat, options.clearance, rooms[k]);
    count.rays += room.rays;
    count.misses += room.misses;
    count.pulled_in += room.outside;
    count.pressed += worst_excess(sections[k], rooms[k]) > 1e-4;
    if (grows) {
      Vec2 shift = growth_to_touch(sections[k], rooms[k]);
      const Vec2 most = (options.most - 1) * belly_share(strip, strip.slices[k].s) * sections[k].radii;
      shift = shift.cwiseMin(most).cwiseMax(-most);
      count.grown += shift.norm() > 1e-4;
      shifts[k] = shift;
    }
  }
  smooth_shifts(shifts);
  std::vector<Vec2> centers(slices.size()), radii(slices.size());
  for (std::size_t k = 0; k < slices.size(); ++k) {
    Section& section = sections[k];
    section.center += shifts[k];
    section.radii += shifts[k].cwiseAbs();
  }
  for (int round = 0; round < 3; ++round) {
    for (std::size_t k = 0; k < slices.size(); ++k) {
      press_in(sections[k], rooms[k], options.least);
      centers[k] = sections[k].center;
      radii[k] = sections[k].radii;
    }
    if (round == 2) break;
    smooth_along(centers, 2);
    smooth_along(radii, 2);
    for (std::size_t k = 0; k < slices.size(); ++k) sections[k] = {centers[k], radii[k]};
  }
  for (std::size_t k = 0; k < slices.size(); ++k) {
    slices[k].center += slices[k].axes.leftCols<2>() * sections[k].center;
    slices[k].radii = sections[k].radii;
  }
  set_slices(strip, slices);
  return count;
}

void check(const Anatomy& fitted, const Anatomy& original, const SkinRays& rays, const FatLayer& fat, const DilateOptions& options) {
  if (options.rays < 8 || options.rays > 64) throw std::invalid_argument(fmt::format("dilate_muscles: {} rays; expected 8 .. 64", options.rays));
  if (fat.thickness.size() != static_cast<std::size_t>(rays.mesh().V.rows())) {
    throw std::invalid_argument(fmt::format("dilate_muscles: a fat layer of {} vertices for a skin of {}", fat.thickness.size(), rays.mesh().V.rows()));
  }
  bool same = fitted.muscles.size() == original.muscles.size();
  for (std::size_t m = 0; same && m < fitted.muscles.size(); ++m) {
    const auto &a = fitted.muscles[m].strips, &b = original.muscles[m].strips;
    same = a.size() == b.size();
    for (std::size_t s = 0; same && s < a.size(); ++s) same = a[s].slices.size() == b[s].slices.size();
  }
  if (!same) throw std::invalid_argument("dilate_muscles: the fitted muscles are not those of the original");
}

}  // namespace

DilateReport dilate_muscles(Anatomy& fitted, const Anatomy& original, const SkinRays& rays, const FatLayer& fat,
                            const DilateOptions& options) {
  check(fitted, original, rays, fat, options);
  DilateReport report;
  const std::size_t count = fitted.muscles.size();
  report.muscles.resize(count);
  std::vector<StripCount> counts(count);
  for (MuscleDilation& m : report.muscles) m.wanted = rest_volume(fitted.muscles[static_cast<std::size_t>(&m - report.muscles.data())]);
  if (options.method == DilateMethod::ecorche) {
    for (int round = 0; round < options.rounds; ++round) {
      const FleshField flesh(fitted, rays, fat);
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4), [&](const auto& range) {
        for (std::size_t m = range.begin(); m < range.end(); ++m) {
          for (Strip& strip : fitted.muscles[m].strips) stretch_strip(strip, static_cast<int>(m), flesh);
        }
      });
    }
  }
  const double thickest = fat.thickness.empty() ? 0 : *std::max_element(fat.thickness.begin(), fat.thickness.end());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4), [&](const auto& range) {
    for (std::size_t m = range.begin(); m < range.end(); ++m) {
      Muscle& muscle = fitted.muscles[m];
      MuscleDilation& result = report.muscles[m];
      if (options.method == DilateMethod::paper) {
        dilate_paper(muscle, original.muscles[m], rays, fat, thickest, options, counts[m], result.factor);
      } else {
        const bool grows = muscle.layer == "superficial";
        for (Strip& strip : muscle.strips) counts[m].add(dilate_strip(strip, grows, rays, fat, options));
      }
      result.volume = muscle.volume = rest_volume(muscle);
      if (options.method == DilateMethod::ecorche) result.factor = result.wanted > 0 ? std::sqrt(result.volume / result.wanted) : 1;
    }
  });
  StripCount all;
  for (const StripCount& c : counts) all.add(c);
  report.slices = slice_count(fitted);
  report.rays = all.rays;
  report.misses = all.misses;
  report.pulled_in = all.pulled_in;
  report.pressed = all.pressed;
  report.grown = all.grown;
  for (const MuscleDilation& m : report.muscles) {
    report.wanted_volume += m.wanted;
    report.volume += m.volume;
  }
  return report;
}

}  // namespace ecorche
