#include "morph/dilation/dilate_strip.h"
#include "morph/dilation/smooth_along.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ecorche::inline v1 {

namespace {

constexpr double kNearSkin = 4e-3;  // m
// How far the layer presses a tendon from its place, m; beyond, the layer is thinner over it, by
// so much of its thickness at most. Larger: the Achilles tendon of short and of heavy people is
// pressed as far as the tibia.
constexpr double kTendonGives = 0.004, kMostThinned = 0.8;
// Share of what is beyond that the layer takes. At 1 all sides press alike, and the last digit says
// which of them is the first.
constexpr double kThinned = 0.9;
// How far a section's centre is pressed, m. Half planes know nothing of a skin that is hollow, as
// along the spine and over the collar bone. Larger: strips turn aside and back there.
constexpr double kMostPressed = 0.012;

// 1 on the belly and towards free ends, fading to 0 within a tenth of the line on the tendons.
double belly_share(const Strip& strip, double s, FreeEnds ends = {}) {
  constexpr double kFade = 0.1;
  const double before = ends.origin ? 0 : strip.belly_begin - s,
               after = ends.insertion ? 0 : s - strip.belly_end;
  return std::clamp(1 - std::max(before, after) / kFade, 0.0, 1.0);
}

// Shifts smoothed along the strip, never beyond the length of the first ones.
void smooth_shifts(std::vector<Vec2>& shifts) {
  const std::vector<Vec2> most = shifts;
  std::vector<Vec2> next = shifts;
  for (int round = 0; round < 8; ++round) {
    for (std::size_t k = 0; k < shifts.size(); ++k) {
      const Vec2 before = shifts[k > 0 ? k - 1 : k],
                 after = shifts[k + 1 < shifts.size() ? k + 1 : k];
      next[k] = (before + 2 * shifts[k] + after) / 4;
      const double length = next[k].norm(), limit = most[k].norm();
      if (length > limit) next[k] *= limit / length;
    }
    shifts.swap(next);
  }
}

// Tendons stay, and the layer gives way. `tendon`: 0 on the belly .. 1.
void thin_layer_over(const SliceSection& section, double tendon, std::vector<HalfPlane>& room) {
  for (HalfPlane& plane : room) {
    const double beyond = section.support(plane.normal) - plane.bound - plane.give - kTendonGives;
    const double thinned = tendon * std::clamp(kThinned * beyond, 0.0, kMostThinned * plane.layer);
    plane.bound += thinned;
    plane.layer -= thinned;
  }
}

// From a section to the skin, m; nothing is known where no ray ended on it.
double room_to_skin(const SliceSection& section, std::span<const HalfPlane> room) {
  double least = std::numeric_limits<double>::infinity();
  for (const HalfPlane& plane : room)
    least = std::min(least, plane.bound + plane.layer - section.support(plane.normal));
  return room.empty() ? 0 : least;
}

}  // namespace

void StripCount::add(const StripCount& other) {
  rays += other.rays;
  misses += other.misses;
  pulled_in += other.pulled_in;
  pressed += other.pressed;
  grown += other.grown;
  near_skin = near_skin || other.near_skin;
}

std::vector<double> heights_in_room(std::span<const Ellipse> slices, int muscle,
                                    const TissueStretch& flesh) {
  constexpr double kOver = 3e-3;  // m from a section to the outermost muscle: another lies over it
  std::vector<double> out;
  for (const Ellipse& slice : slices) {
    const TissuePull pull = flesh.at(slice.center, muscle);
    const double half =
        (slice.axes.leftCols<2>().transpose() * pull.outwards).cwiseProduct(slice.radii).norm();
    out.push_back(pull.height + half + kOver < pull.tall ? pull.height / pull.tall : 1);
  }
  return out;
}

void stretch_strip(const Strip& strip, std::span<Ellipse> slices, int muscle, FreeEnds ends,
                   std::span<const double> heights, const TissueStretch& flesh) {
  std::vector<Vec3> shifts;
  std::vector<Vec2> scales;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const Ellipse& slice = slices[k];
    const TissuePull pull = flesh.at(slice.center, muscle);
    // Flesh that grows outwards also spreads sideways, at half the rate; pressed flesh keeps its
    // width. Tendons do not grow.
    const double s = strip.slices[k].s, belly = belly_share(strip, s),
                 free = belly_share(strip, s, ends);
    const double stretch = pull.stretch > 1 ? 1 + belly * (pull.stretch - 1) : pull.stretch;
    const double sideways = stretch > 1 ? 1 + (stretch - 1) / 2 : 1;
    Vec2 scale;
    double half = 0;
    for (int axis = 0; axis < 2; ++axis) {
      const double along = std::pow(slice.axes.col(axis).dot(pull.outwards), 2);
      scale[axis] = along * stretch + (1 - along) * sideways;
      half += along * std::pow(scale[axis] * slice.radii[axis], 2);
    }
    const double most = std::max(0.0, pull.free - std::sqrt(half)),
                 kept = heights[k] * pull.room - pull.height;
    const double shift = std::max(belly * pull.shift, std::min(free * pull.shift, kept));
    shifts.push_back((pull.shift > 0 ? std::min(shift, most) : pull.shift) * pull.outwards);
    scales.push_back(scale);
  }
  smooth_along(shifts, 3);
  smooth_along(scales, 3);
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const Vec3 normal = slices[k].axes.col(2);  // sections stay where they are along the line
    slices[k].center += shifts[k] - normal * normal.dot(shifts[k]);
    slices[k].radii = slices[k].radii.cwiseProduct(scales[k]);
  }
}

StripCount grow_strip(const Strip& strip, std::span<Ellipse> slices, bool grows,
                      const SkinRays& rays, const FatLayer& fat, const GrowthLimits& limits) {
  StripCount count;
  std::vector<std::vector<HalfPlane>> rooms(slices.size());
  std::vector<SliceSection> sections(slices.size());
  std::vector<Vec2> shifts(slices.size(), Vec2::Zero());
  for (std::size_t k = 0; k < slices.size(); ++k) {
    sections[k].radii = slices[k].radii;
    const RoomCount room =
        find_room(slices[k], limits.directions, rays, fat, limits.clearance, rooms[k]);
    thin_layer_over(sections[k], 1 - belly_share(strip, strip.slices[k].s), rooms[k]);
    count.rays += room.rays;
    count.misses += room.misses;
    count.pulled_in += room.outside;
    count.pressed += worst_excess(sections[k], rooms[k]) > 1e-4;
    if (grows) {
      Vec2 shift = growth_to_touch(sections[k], rooms[k]);
      const Vec2 most =
          (limits.most - 1) * belly_share(strip, strip.slices[k].s) * sections[k].radii;
      shift = shift.cwiseMin(most).cwiseMax(-most);
      count.grown += shift.norm() > 1e-4;
      shifts[k] = shift;
    }
  }
  smooth_shifts(shifts);
  std::vector<Vec2> centers(slices.size()), radii(slices.size());
  for (std::size_t k = 0; k < slices.size(); ++k) {
    sections[k].center += shifts[k];
    sections[k].radii += shifts[k].cwiseAbs();
  }
  const std::vector<SliceSection> before = sections;
  for (int round = 0; round < 3; ++round) {
    for (std::size_t k = 0; k < slices.size(); ++k) {
      press_in(sections[k], rooms[k], limits.least);
      const Vec2 way = sections[k].center - before[k].center;
      if (way.norm() > kMostPressed)
        sections[k].center = before[k].center + kMostPressed * way.normalized();
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
    count.near_skin = count.near_skin || room_to_skin(sections[k], rooms[k]) <
                                             kNearSkin + slices[k].radii.minCoeff() / 2;
  }
  return count;
}

}  // namespace ecorche::inline v1
