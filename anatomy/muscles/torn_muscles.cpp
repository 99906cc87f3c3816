#include "anatomy/muscles/torn_muscles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <unordered_map>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/surface_edges.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kNeedleAtRest = 0.008;  // m
// From here on a muscle counts as torn. Set by looking (docs/check.md): below, what shows are
// dents, ridges and blunt edges.
struct TornFrom {
  int raised = 0;
  double worst = 0;  // m
};
constexpr TornFrom kManyRaised{20, 0.015}, kFarRaised{3, 0.025};

bool same_sections(const Muscle& a, const Muscle& b) {
  return std::ranges::equal(a.strips, b.strips, [](const Strip& s, const Strip& t) {
    return s.slices.size() == t.slices.size() && s.slices.size() >= 2;
  });
}

// A muscle drawn by itself.
struct DrawnAlone {
  MuscleSurface surface;
  Points positions;

  explicit DrawnAlone(const Muscle& muscle) {
    Anatomy alone;
    alone.muscles.push_back(muscle);
    surface = make_muscle_surface(alone);
    update_muscle_surface(surface, rest_slices(alone), positions);
  }
};

double area_of(const DrawnAlone& muscle) {
  double twice = 0;
  for (Eigen::Index f = 0; f < muscle.surface.F.rows(); ++f) {
    const auto corner = [&](int k) { return Vec3(muscle.positions.row(muscle.surface.F(f, k))); };
    twice += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  }
  return std::max(twice / 2, 1e-9);
}

MuscleTear measure_tear(const Muscle& muscle, const Muscle& reference) {
  MuscleTear out;
  const DrawnAlone now(muscle), then(reference);
  if (now.surface.F.rows() != then.surface.F.rows()) return out;
  out.known = true;
  const std::vector<SurfaceEdge> edges = inner_edges(then.surface, then.positions);
  const Standing was = standing_off(then.surface, edges, then.positions),
                 is = standing_off(now.surface, edges, now.positions);
  // A muscle that is larger as a whole is no less whole.
  const double size = std::sqrt(std::max(1.0, area_of(now) / area_of(then)));
  for (std::size_t v = 0; v < is.off.size(); ++v) {
    out.needles += is.off[v] > size * was.off[v] + kNeedleAtRest;
    out.raised += is.out[v] > size * was.out[v] + kNeedleAtRest;
    out.needle = std::max(out.needle, is.out[v] - size * was.out[v]);
  }
  return out;
}

}  // namespace

std::vector<MuscleTear> measure_tears(const std::vector<Muscle>& muscles,
                                      const std::vector<Muscle>& reference) {
  std::unordered_map<std::string_view, const Muscle*> by_name;
  for (const Muscle& muscle : reference) by_name[muscle.name] = &muscle;
  std::vector<MuscleTear> out(muscles.size());
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    const auto found = by_name.find(muscles[m].name);
    if (found == by_name.end() || muscles[m].strips.empty() ||
        !same_sections(muscles[m], *found->second))
      continue;
    out[m] = measure_tear(muscles[m], *found->second);
  }
  return out;
}

bool is_torn(const MuscleTear& tear) {
  return std::ranges::any_of(std::array{kManyRaised, kFarRaised}, [&](const TornFrom& from) {
    return tear.raised >= from.raised && tear.needle >= from.worst;
  });
}

std::vector<int> torn_muscles(const std::vector<MuscleTear>& tears) {
  std::vector<int> out;
  for (std::size_t m = 0; m < tears.size(); ++m)
    if (is_torn(tears[m])) out.push_back(int(m));
  std::ranges::stable_sort(out, [&](int a, int b) { return tears[a].needle > tears[b].needle; });
  return out;
}

}  // namespace ecorche::inline v1
