// Rays against a surface: where a straight line from inside meets the skin.
//
// A bounding volume hierarchy built once (Embree, robust: no ray slips through an edge). Single
// rays: those of dilation are not coherent enough for packets. Single precision inside, so that
// coordinates of a body in metres keep about 0.1 micrometre.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct RayHit {
  int triangle = -1;   // -1: nothing was met
  float distance = 0;  // along the unit direction, m
  float u = 0, v = 0;  // barycentric weights of corners 1 and 2
  // of the triangle, outwards, unit length; zero for one without area
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float facing = 0;  // direction . normal: positive when the ray leaves the body
};

// Where a ray has met a mesh of these triangles, of values of its vertices.
inline float value_at(const Triangles& F, const RayHit& hit, std::span<const float> values) {
  const auto face = F.row(hit.triangle);
  return (1 - hit.u - hit.v) * values[std::size_t(face[0])] + hit.u * values[std::size_t(face[1])] +
         hit.v * values[std::size_t(face[2])];
}

// thorough: the fastest queries; quick: the hierarchy is ready three times sooner, for few rays.
enum class RayBuild { thorough, quick };

// Queries are const and may run in several threads.
class SkinRays {
 public:
  // Throws std::invalid_argument for an empty mesh, indices out of range or coordinates that are
  // not finite.
  explicit SkinRays(const TriMesh& mesh, RayBuild build = RayBuild::thorough);
  ~SkinRays();
  SkinRays(SkinRays&&) noexcept;
  SkinRays& operator=(SkinRays&&) noexcept;

  // The first triangle that a ray meets between `from` and `to` metres. Precondition: direction of
  // length one.
  RayHit first_hit(const Vec3& origin, const Vec3& direction,
                   double to = std::numeric_limits<double>::infinity(), double from = 0) const;

  const TriMesh& mesh() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche::inline v1
