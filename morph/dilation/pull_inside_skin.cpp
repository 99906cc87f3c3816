#include "morph/dilation/pull_inside_skin.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "morph/dilation/slice_clearance.h"

namespace ecorche::inline v1 {

namespace {

constexpr double kMargin = 0.4e-3;     // m below the skin, target of points that were outside
constexpr double kCentreDepth = 2e-3;  // m below the skin, for centres that were outside
constexpr double kLeast = 0.2;         // of a half axis, that a round leaves
constexpr int kRounds = 12;
constexpr double kInPlane = 0.3;  // sine: a skin more across the strip than this is no side of it

// 26 directions to all sides.
const std::array<Vec3, 26>& all_sides() {
  static const std::array<Vec3, 26> sides = [] {
    std::array<Vec3, 26> out;
    int n = 0;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          if (x != 0 || y != 0 || z != 0) out[n++] = Vec3(x, y, z).normalized();
    return out;
  }();
  return sides;
}

// Inside a closed skin a ray to any side ends on the skin's inner side; where folds cross, to most
// sides. These look the same in a mirror.
bool is_inside(const Vec3& p, const SkinRays& rays) {
  const auto leaves = [&](const Vec3& side) {
    const RayHit hit = rays.first_hit(p, side);
    return hit.triangle >= 0 && hit.facing > 0;
  };
  const bool front = leaves(Vec3::UnitZ()), back = leaves(-Vec3::UnitZ());
  return front == back ? front : leaves(Vec3::UnitY());
}

// A point outside the skin brought inside through the nearest place that a ray meets.
Vec3 brought_inside(const Vec3& p, const SkinRays& rays) {
  Vec3 best = p;
  double nearest = 1e300;
  for (const Vec3& side : all_sides()) {
    const RayHit hit = rays.first_hit(p, side, 0.1);
    if (hit.triangle < 0 || hit.facing >= 0 || hit.distance >= nearest) continue;
    nearest = hit.distance;
    best = p + hit.distance * side - kCentreDepth * hit.normal.cast<double>();
  }
  return best;
}

struct Push {
  Vec3 normal = Vec3::Zero();  // of the skin there, outwards
  double depth = 0;            // to go inwards, m
};

void take_larger(Push& push, const Push& other) {
  if (other.depth > push.depth) push = other;
}

// Presses a section in by a depth along the skin's normal: half of it by getting thinner, half by
// moving.
void press(Ellipse& slice, const Push& push) {
  const Vec2 across = slice.axes.leftCols<2>().transpose() * push.normal;
  const double sine = across.norm();
  // the strip's end points out of the skin: its round cap gets flatter as the section gets thinner
  if (sine < kInPlane) {
    slice.radii *= std::max(1 - push.depth / std::max(slice.radii.minCoeff(), 1e-6), 0.5);
    return;
  }
  SliceSection section{Vec2::Zero(), slice.radii};
  const Vec2 n = across / sine;
  const HalfPlane plane{n, section.support(n) - push.depth / sine, 0, 0};
  press_in(section, {&plane, 1}, kLeast);
  slice.center += slice.axes.leftCols<2>() * section.center;
  slice.radii = section.radii;
}

// What the points outside ask of the sections under them. Both as in `slices`.
int find_pushes(const MuscleSurface& surface, std::span<const Ellipse> slices, const SkinRays& rays,
                std::vector<Push>& pushes) {
  Points positions;
  update_muscle_surface(surface, slices, positions);
  std::vector<Push> found(positions.rows());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, found.size(), 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Vec3 p = positions.row(i), from = slices[surface.slice[i]].center;
      const double length = (p - from).norm();
      if (length <= 0) continue;
      const RayHit hit = rays.first_hit(from, (p - from) / length, length);
      if (hit.triangle < 0 || is_inside(p, rays)) continue;
      const double beyond = (length - hit.distance) * std::max(hit.facing, 0.2f);
      found[i] = {hit.normal.cast<double>(), beyond + kMargin};
    }
  });
  int outside = 0;
  pushes.assign(slices.size(), {});
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].depth <= 0) continue;
    ++outside;
    for (int t = surface.term_begin[i]; t < surface.term_begin[i + 1]; ++t)
      if (surface.terms[t].weight > 0.2f) take_larger(pushes[surface.terms[t].slice], found[i]);
  }
  return outside;
}

// One muscle by itself, with its sections.
struct Suspect {
  std::size_t muscle = 0;
  std::span<Ellipse> slices;
};

InsideReport pull_inside_skin(Muscle& muscle, std::span<Ellipse> slices, const SkinRays& rays) {
  InsideReport report;
  Anatomy alone;
  alone.muscles.push_back(muscle);
  std::vector<Push> pushes;
  for (int round = 0;; ++round) {
    // A sheet's thickness follows from its sections, so its surface is made anew.
    const MuscleSurface surface = make_muscle_surface(alone);
    report.left = find_pushes(surface, slices, rays, pushes);
    report.rays += surface.vertices();
    if (round == 0) report.outside = report.left;
    if (report.left == 0 || round == kRounds) break;
    std::size_t first = 0;
    for (Strip& strip : alone.muscles[0].strips) {
      const std::size_t count = strip.slices.size();
      for (std::size_t k = 0; k < count; ++k) {
        Push push = pushes[first + k];
        // Neighbours go half the way, so that the strip gets no notch.
        for (const std::size_t other : {k > 0 ? k - 1 : k, k + 1 < count ? k + 1 : k}) {
          const Push& beside = pushes[first + other];
          take_larger(push, {beside.normal, beside.depth / 2});
        }
        if (push.depth > 0) press(slices[first + k], push);
      }
      set_slices(strip, slices.subspan(first, count));
      first += count;
    }
  }
  muscle = std::move(alone.muscles[0]);
  return report;
}

}  // namespace

InsideReport pull_inside_skin(std::vector<Muscle>& muscles, std::span<Ellipse> slices,
                              std::span<const char> suspects, const SkinRays& rays) {
  std::vector<Suspect> looked_at;
  std::size_t first = 0;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    std::size_t count = 0;
    for (const Strip& strip : muscles[m].strips) count += strip.slices.size();
    if (suspects[m]) looked_at.push_back({m, slices.subspan(first, count)});
    first += count;
  }
  std::vector<InsideReport> reports(looked_at.size());
  tbb::parallel_for(std::size_t{0}, looked_at.size(), [&](std::size_t k) {
    Suspect& suspect = looked_at[k];
    Muscle& muscle = muscles[suspect.muscle];
    bool moved = false;
    for (Ellipse& slice : suspect.slices) {
      if (is_inside(slice.center, rays)) continue;
      const Vec3 inside = brought_inside(slice.center, rays);
      slice.center += slice.axes.leftCols<2>() *
                      (slice.axes.leftCols<2>().transpose() * (inside - slice.center));
      moved = true;
    }
    if (moved) set_slices(muscle, suspect.slices);
    reports[k] = pull_inside_skin(muscle, suspect.slices, rays);
    reports[k].rays += static_cast<long long>(suspect.slices.size());
  });
  InsideReport all;
  for (const InsideReport& report : reports) {
    all.rays += report.rays;
    all.outside += report.outside;
    all.left += report.left;
  }
  return all;
}

}  // namespace ecorche::inline v1
