// Exact nearest points and rays on a triangle soup.
//
// The tree culls in float with a margin; the distances that decide are computed in double, so the
// answer equals that of a search over all triangles to 1e-9 m (ties: the lower triangle index).
#pragma once

#include <memory>
#include <optional>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct SurfacePoint {
  int triangle = -1;
  double distance = 0;
  Vec3 point = Vec3::Zero();
};

// Nearest point of one triangle (Ericson 2005, by Voronoi regions).
Vec3 nearest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

// Queries are const and may run in several threads.
class NearestSurface {
 public:
  // Precondition: at least one triangle, indices in range, finite coordinates; otherwise
  // std::invalid_argument.
  explicit NearestSurface(const TriMesh& mesh);
  ~NearestSurface();
  NearestSurface(const NearestSurface&) = delete;
  NearestSurface& operator=(const NearestSurface&) = delete;

  // `hint`: a triangle that may be near, such as the answer for a neighbouring point; it saves time
  // and changes nothing else.
  SurfacePoint nearest(const Vec3& p, int hint = -1) const;
  // None where the nearest point is farther.
  std::optional<SurfacePoint> nearest_within(const Vec3& p, double distance) const;
  // Whether the open segment meets a triangle.
  bool blocked(const Vec3& from, const Vec3& to) const;
  // Distance along the unit direction to the first triangle.
  std::optional<double> cast(const Vec3& origin, const Vec3& direction) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace ecorche::inline v1
