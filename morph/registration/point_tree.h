// Nearest points with agreeing normals.
#pragma once

#include <memory>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Points of a surface, and what each stands for.
struct SurfacePoints {
  Points points;   // #N x 3, m
  Points normals;  // #N x 3, unit; zero where unknown
};

struct NearPoint {
  int index = -1;
  double distance = 0;  // m, normals counted in
};

// A k-d tree over places and normals: distance^2 = |p - q|^2 + reach^2 |m - n|^2, so that the back
// of a hand is far from its palm however thin it is.
class PointTree {
 public:
  // `reach`: m. Precondition: at least one point, all finite.
  PointTree(const SurfacePoints& surface, double reach);
  ~PointTree();
  PointTree(PointTree&&) noexcept;
  PointTree& operator=(PointTree&&) noexcept;

  NearPoint nearest(const Vec3& point, const Vec3& normal) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche::inline v1
