#include "anatomy/muscles/surface_reference.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {
namespace {

double area_of(const DrawnMuscle& muscle) {
  double twice = 0;
  for (Eigen::Index f = 0; f < muscle.surface.F.rows(); ++f) {
    const auto corner = [&](int k) { return Vec3(muscle.positions.row(muscle.surface.F(f, k))); };
    twice += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  }
  return std::max(twice / 2, 1e-9);
}

}  // namespace

DrawnMuscle::DrawnMuscle(const Muscle& muscle) {
  Anatomy alone;
  alone.muscles.push_back(muscle);
  surface = make_muscle_surface(alone);
  update_muscle_surface(surface, rest_slices(alone), positions);
}

bool same_sections(const Muscle& a, const Muscle& b) {
  return std::ranges::equal(a.strips, b.strips, [](const Strip& s, const Strip& t) {
    return s.slices.size() == t.slices.size() && s.slices.size() >= 2;
  });
}

SurfaceReference::SurfaceReference(const Muscle& reference)
    : drawn_(reference),
      edges_(inner_edges(drawn_.surface, drawn_.positions)),
      standing_(standing_off(drawn_.surface, edges_, drawn_.positions)),
      area_(area_of(drawn_)) {}

bool SurfaceReference::matches(const DrawnMuscle& muscle) const {
  return muscle.surface.F.rows() == drawn_.surface.F.rows();
}

Standing SurfaceReference::standing_beyond(const DrawnMuscle& muscle) const {
  Standing out = standing_off(muscle.surface, edges_, muscle.positions);
  const double size = std::sqrt(std::max(1.0, area_of(muscle) / area_));
  const auto beyond = [&](double is, double was) {
    return std::copysign(std::max(0.0, std::abs(is) - size * std::abs(was)), is);
  };
  for (std::size_t v = 0; v < out.off.size(); ++v) {
    out.off[v] = beyond(out.off[v], standing_.off[v]);
    out.out[v] = beyond(out.out[v], standing_.out[v]);
  }
  return out;
}

}  // namespace ecorche::inline v1
