// Points in the fat of the skin, which go with it: where it opens, at the mouth and the lids, the
// map of the inside knows of no slit. Private to the room.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/nearest_surface.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {

struct SkinBond {
  std::array<int, 3> vertices{};  // of the skin as it is sorted in frames
  Vec3 weights = Vec3::Zero();    // of them
  double depth = 0;               // m, along the normal
  Vec3 aside = Vec3::Zero();      // m, at rest: what the normal does not explain
  double share = 0;               // from 0, on bone: goes with the map, to 1: goes with the skin
};

class SkinBonder {
 public:
  // `rays`: of the skin; kept as a reference. `sorted`: places of its vertices in frames.
  SkinBonder(const Anatomy& anatomy, const SkinRays& rays, std::span<const int> sorted);
  // `across`: a sheet's thickness, on one of whose sides lies its skin. What is nearest may be
  // another's: lips touch.
  SkinBond bond(const Vec3& point, const Vec3& across) const;

 private:
  SurfacePoint skin_over(const Vec3& point, const Vec3& across) const;

  const SkinRays& rays_;
  std::span<const int> sorted_;
  Points normals_;
  NearestSurface surface_, bones_;
};

// `positions`, `normals`: of the skin in a pose, #V x 4. `turn`: of the map there. `mapped`: where
// the map brings the point.
Vec3 bonded(const SkinBond& bond, std::span<const float> positions, std::span<const float> normals,
            const Mat3& turn, const Vec3& mapped);

}  // namespace ecorche::inline v1
