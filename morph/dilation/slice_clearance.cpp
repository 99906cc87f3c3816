#include "morph/dilation/slice_clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ecorche::inline v1 {

namespace {

constexpr double kTwoPi = 6.283185307179586;
// Fraction of the layer's thickness that a section may press into it. Larger: less fat over
// muscles; smaller: more sections are flattened.
constexpr double kGive = 0.5;

// The half plane that a ray's end stands for. A tangent plane that the ray meets at a shallow
// angle, or that lies almost in the slice's plane, says little about the section; then the ray's
// own direction bounds it.
HalfPlane half_plane(const Ellipse& slice, const Vec2& direction, const RayHit& hit, double layer) {
  const Vec3 n = hit.normal.cast<double>();
  const Vec2 in_plane(n.dot(slice.axes.col(0)), n.dot(slice.axes.col(1)));
  const double steepness = in_plane.norm();
  constexpr double kShallow = 0.5;  // cosine
  if (steepness > kShallow && in_plane.dot(direction) > kShallow * steepness) {
    const double across = layer / steepness;
    return {in_plane / steepness, hit.distance * hit.facing / steepness - across, kGive * across,
            across};
  }
  return {direction, hit.distance - layer / kShallow, kGive * layer / kShallow, layer / kShallow};
}

// Into a skin that the centre lies outside of: through the nearest place where a ray enters. What
// is farther off is another part of the body.
bool pull_in(Ellipse& slice, std::span<const Vec2> directions, const SkinRays& rays,
             const FatLayer& fat) {
  Vec3 best = Vec3::Zero();
  constexpr double kFurthest = 0.04;  // m
  double nearest = kFurthest;
  bool found = false;
  for (const Vec2& in_plane : directions) {
    const Vec3 direction = slice.axes.leftCols<2>() * in_plane;
    const RayHit hit = rays.first_hit(slice.center, direction);
    if (hit.triangle < 0 || hit.facing >= 0 || hit.distance >= nearest) continue;
    nearest = hit.distance;
    found = true;
    best = direction * (hit.distance + fat.at(rays.mesh().F, hit) + 1e-3);
  }
  slice.center += best;
  return found;
}

}  // namespace

std::vector<Vec2> ray_directions(int count) {
  std::vector<Vec2> directions;
  for (int k = 0; k < count; ++k)
    directions.emplace_back(std::cos(kTwoPi * k / count), std::sin(kTwoPi * k / count));
  return directions;
}

RoomCount find_room(Ellipse& slice, std::span<const Vec2> directions, const SkinRays& rays,
                    const FatLayer& fat, double clearance, std::vector<HalfPlane>& room) {
  RoomCount result;
  for (int attempt = 0; attempt < 2; ++attempt) {
    room.clear();
    result.rays += directions.size();
    int entering = 0;
    for (const Vec2& direction : directions) {
      const RayHit hit = rays.first_hit(slice.center, slice.axes.leftCols<2>() * direction);
      if (hit.triangle < 0) {
        ++result.misses;
        continue;
      }
      entering += hit.facing < 0;
      if (hit.facing > 0)
        room.push_back(half_plane(slice, direction, hit, fat.at(rays.mesh().F, hit) + clearance));
    }
    // From inside a closed skin all rays leave it, but where it crosses itself (under a breast,
    // between thighs) some enter a part of it first. Where most enter, or many meet nothing, the
    // centre is outside.
    const auto hits = static_cast<long long>(directions.size()) - result.misses;
    const bool outside =
        2 * entering > hits || 4 * result.misses > static_cast<long long>(directions.size());
    if (outside) result.misses = 0;
    if (!outside || attempt == 1) break;
    result.outside = true;
    if (!pull_in(slice, directions, rays, fat)) break;
  }
  return result;
}

double worst_excess(const SliceSection& section, std::span<const HalfPlane> room, int* which) {
  double worst = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < room.size(); ++k) {
    const double excess = section.support(room[k].normal) - room[k].bound - room[k].give;
    if (excess <= worst) continue;
    worst = excess;
    if (which) *which = int(k);
  }
  return worst;
}

void press_in(SliceSection& section, std::span<const HalfPlane> room, double least) {
  const Vec2 smallest = least * section.radii;
  constexpr int kRounds = 24;
  constexpr double kEnough = 2e-5;  // m
  for (int round = 0; round < kRounds; ++round) {
    int k = 0;
    const double excess = worst_excess(section, room, &k);
    if (excess <= kEnough) return;
    const Vec2 n = room[k].normal;
    const Vec2 r = section.radii;
    // The support along n falls by half of the excess by shrinking (to first order) and by half of
    // it by shifting, so that the support on the other side stays.
    const Vec2 squares = n.cwiseProduct(n);
    const double slope = (r.cwiseProduct(squares).squaredNorm()) / r.cwiseProduct(n).norm();
    const double rate = slope > 1e-12 ? excess / 2 / slope : 0;
    section.radii = (r - rate * r.cwiseProduct(squares)).cwiseMax(smallest);
    const double shrunk = r.cwiseProduct(n).norm() - section.radii.cwiseProduct(n).norm();
    section.center -= (excess - shrunk) * n;
  }
}

namespace {

// The body's outside as seen from a section: the mean direction of the half planes that are near.
Vec2 outwards(const SliceSection& section, std::span<const HalfPlane> room) {
  const double scale = section.radii.maxCoeff();
  Vec2 sum = Vec2::Zero();
  for (const HalfPlane& plane : room) {
    const double gap = std::max(0.0, plane.bound - section.support(plane.normal));
    sum += plane.normal / (0.05 * scale * scale + gap * gap);
  }
  return sum;
}

}  // namespace

Vec2 growth_to_touch(const SliceSection& section, std::span<const HalfPlane> room) {
  if (room.empty()) return Vec2::Zero();
  const Vec2 out = outwards(section, room);
  const int axis = std::abs(out.y()) >= std::abs(out.x()) ? 1 : 0;
  const double sign = out[axis] >= 0 ? 1 : -1;
  const double along = section.radii[axis], across = section.radii[1 - axis];
  // With a shift t and the half axis r + t, n . c + sign m t + sqrt(A + (r + t)^2 m^2) = bound has
  // one root in t.
  double least = std::numeric_limits<double>::infinity();
  for (const HalfPlane& plane : room) {
    const double m = sign * plane.normal[axis];
    if (m < 1e-3) continue;
    const double q = plane.bound - plane.normal.dot(section.center);
    const double A = across * plane.normal[1 - axis];
    const double t =
        (q * q - A * A - along * along * m * m) / (2 * m * (along * m + std::max(q, 0.0)));
    least = std::min(least, q < 0 ? 0.0 : t);
  }
  if (!std::isfinite(least) || least <= 0) return Vec2::Zero();
  Vec2 growth = Vec2::Zero();
  growth[axis] = sign * least;
  return growth;
}

}  // namespace ecorche::inline v1
