#include "anatomy/queries/skin_bonds.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "anatomy/compute/smooth_step.h"

namespace ecorche::inline v1 {
namespace {

// Of the way from bone to skin: up to here points go with the map, from there on with the skin.
// Nearer to 0, muscles leave their bones where the skin slides; nearer to 1, lips stay behind.
constexpr double kWithMap = 0.05, kWithSkin = 0.5;
constexpr double kFarthest = 0.03;  // m across a sheet
constexpr float kAslant = 0.3f;     // cosine: skin that a line across leaves more aslant is another
constexpr double kPastWall = 1e-5;  // m
constexpr double kFromLip = 0.004;  // m, by which a place is moved from the other lip
constexpr double kLips = 0.010;     // m, that lips are high
constexpr int kMostWalls = 8;       // that are entered on the way: of the mouth, of the nose

// Weights of a triangle's corners at a point of it.
Vec3 corner_weights(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 area = (b - a).cross(c - a);
  const double whole = area.squaredNorm();
  if (whole <= 0) return Vec3(1, 0, 0);
  const double at_b = (p - a).cross(c - a).dot(area) / whole,
               at_c = (b - a).cross(p - a).dot(area) / whole;
  return Vec3(1 - at_b - at_c, at_b, at_c);
}

}  // namespace

Vec3 SkinBond::moved(const Vec3& place, const Vec3& outwards, const Mat3& turn,
                     const Vec3& mapped) const {
  const Vec3 with_skin = place - depth * outwards.stableNormalized() + turn * aside;
  return mapped + share * (with_skin - mapped);
}

SkinBonder::SkinBonder(const TriMesh& bones, const SkinRays& rays, Points normals,
                       std::optional<MouthLine> mouth)
    : rays_(rays),
      normals_(std::move(normals)),
      mouth_(std::move(mouth)),
      surface_(rays.mesh()),
      bones_(bones) {}

bool SkinBonder::at_lips(const Vec3& point) const {
  return mouth_ && mouth_->about(point) && mouth_->spans(point.x());
}

bool SkinBonder::of_one_lip(const Vec3& a, const Vec3& b) const {
  return !at_lips(a) || (mouth_->over(a) < 0) == (mouth_->over(b) < 0);
}

SurfacePoint SkinBonder::skin_over(const Vec3& point, const Vec3& across) const {
  SurfacePoint out;
  for (const Vec3& way : {across, Vec3(-across)}) {
    RayHit hit = rays_.first_hit(point, way, kFarthest);
    for (int walls = 0; walls < kMostWalls && hit.triangle >= 0 && hit.facing <= 0; ++walls)
      hit = rays_.first_hit(point, way, kFarthest, double(hit.distance) + kPastWall);
    if (hit.triangle < 0 || hit.facing <= kAslant) continue;
    const double distance = double(hit.distance);
    if (!of_one_lip(point, point + distance * way)) continue;
    if (out.triangle < 0 || distance < out.distance)
      out = {hit.triangle, distance, point + distance * way};
  }
  if (out.triangle >= 0) return out;
  out = surface_.nearest(point);
  if (!of_one_lip(point, out.point))  // from a place farther from the other lip
    out =
        surface_.nearest(point + (mouth_->over(point) < 0 ? -kFromLip : kFromLip) * Vec3::UnitY());
  return out;
}

SkinBond SkinBonder::bond(const Vec3& point, const Vec3& across) const {
  const TriMesh& skin = rays_.mesh();
  const SurfacePoint on = skin_over(point, across);
  const auto corner = [&](int k) { return Vec3(skin.V.row(skin.F(on.triangle, k))); };
  SkinBond out;
  out.weights = corner_weights(corner(0), corner(1), corner(2), on.point);
  out.normal.setZero();
  Vec3 place = Vec3::Zero();  // rays end in single precision; this is where the weights say
  for (int k = 0; k < 3; ++k) {
    place += out.weights[k] * corner(k);
    out.vertices[std::size_t(k)] = skin.F(on.triangle, k);
    out.normal += out.weights[k] * Vec3(normals_.row(skin.F(on.triangle, k)));
  }
  out.normal.normalize();
  out.depth = (place - point).dot(out.normal);
  out.aside = point - place + out.depth * out.normal;
  const double from_bone = bones_.nearest(point).distance;
  out.share =
      smooth_step(kWithMap, kWithSkin, from_bone / (from_bone + std::abs(out.depth) + 1e-9));
  // Teeth of either jaw lie near either lip.
  if (at_lips(point))
    out.share =
        std::max(out.share, 1 - smooth_step(kLips, 2 * kLips, std::abs(mouth_->over(point))));
  return out;
}

}  // namespace ecorche::inline v1
