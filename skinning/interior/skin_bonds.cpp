#include "skinning/interior/skin_bonds.h"

#include <cmath>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {
namespace {

// Of the way from bone to skin: up to here points go with the map, from there on with the skin.
// Nearer to 0, muscles leave their bones where the skin slides; nearer to 1, lips stay behind.
constexpr double kWithMap = 0.05, kWithSkin = 0.5;
constexpr double kFarthest = 0.03;  // m across a sheet
constexpr float kAslant = 0.3f;     // cosine: skin that a line across leaves more aslant is another

TriMesh all_bones(const Anatomy& anatomy) {
  std::vector<const TriMesh*> bones;
  for (const Bone& bone : anatomy.bones) bones.push_back(&bone.mesh);
  return join_meshes(bones);
}

Vec3 row_of(std::span<const float> rows, int vertex) {
  const std::size_t v = 4 * std::size_t(vertex);
  return Vec3(rows[v], rows[v + 1], rows[v + 2]);
}

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

SkinBonder::SkinBonder(const Anatomy& anatomy, const SkinRays& rays, std::span<const int> sorted)
    : rays_(rays),
      sorted_(sorted),
      normals_(vertex_normals(rays.mesh())),
      surface_(rays.mesh()),
      bones_(all_bones(anatomy)) {}

SurfacePoint SkinBonder::skin_over(const Vec3& point, const Vec3& across) const {
  SurfacePoint out;
  for (const Vec3& way : {across, Vec3(-across)}) {
    const RayHit hit = rays_.first_hit(point, way, kFarthest);
    if (hit.triangle < 0 || hit.facing <= kAslant) continue;
    const double distance = double(hit.distance);
    if (out.triangle < 0 || distance < out.distance)
      out = {hit.triangle, distance, point + distance * way};
  }
  return out.triangle < 0 ? surface_.nearest(point) : out;
}

SkinBond SkinBonder::bond(const Vec3& point, const Vec3& across) const {
  const TriMesh& skin = rays_.mesh();
  const SurfacePoint on = skin_over(point, across);
  const auto corner = [&](int k) { return Vec3(skin.V.row(skin.F(on.triangle, k))); };
  SkinBond out;
  out.weights = corner_weights(corner(0), corner(1), corner(2), on.point);
  Vec3 normal = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    out.vertices[std::size_t(k)] = sorted_[std::size_t(skin.F(on.triangle, k))];
    normal += out.weights[k] * Vec3(normals_.row(skin.F(on.triangle, k)));
  }
  normal.normalize();
  out.depth = (on.point - point).dot(normal);
  out.aside = point - on.point + out.depth * normal;
  const double from_bone = bones_.nearest(point).distance;
  out.share =
      smooth_step(kWithMap, kWithSkin, from_bone / (from_bone + std::abs(out.depth) + 1e-9));
  return out;
}

Vec3 bonded(const SkinBond& bond, std::span<const float> positions, std::span<const float> normals,
            const Mat3& turn, const Vec3& mapped) {
  if (bond.share <= 0) return mapped;
  Vec3 on = Vec3::Zero(), normal = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    const int vertex = bond.vertices[std::size_t(k)];
    on += bond.weights[k] * row_of(positions, vertex);
    normal += bond.weights[k] * row_of(normals, vertex);
  }
  const Vec3 with_skin = on - bond.depth * normal.stableNormalized() + turn * bond.aside;
  return mapped + bond.share * (with_skin - mapped);
}

}  // namespace ecorche::inline v1
