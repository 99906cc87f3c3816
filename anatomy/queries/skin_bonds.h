// Points in the fat of the skin, which go with it: by the depth below a place of its surface,
// nearer to bone the less. The skin may be another person's of the same triangles, or the same
// skin's in a pose. Where it opens, at the mouth and the lids, maps of the inside know of no slit.
#pragma once

#include <array>
#include <optional>

#include "anatomy/anatomy.h"
#include "anatomy/queries/mouth_line.h"
#include "anatomy/queries/nearest_surface.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {

struct SkinBond {
  std::array<int, 3> vertices{};  // of the skin
  Vec3 weights = Vec3::Zero();    // of them
  Vec3 normal = Vec3::UnitY();    // of the skin there, outwards
  double depth = 0;               // m, along the normal
  Vec3 aside = Vec3::Zero();      // m: what the normal does not explain
  double share = 0;  // from 0, on bone: goes with what lies inside, to 1: with the skin

  // Where the point goes when the skin's place and its outward normal are these. `turn`: of what
  // lies aside. `mapped`: where it goes with what lies inside.
  Vec3 moved(const Vec3& place, const Vec3& outwards, const Mat3& turn, const Vec3& mapped) const;
};

class SkinBonder {
 public:
  // `bones`: all, as one mesh. `rays`: of the skin; kept as a reference. `normals`: unit, of the
  // skin's vertices. `mouth`: of the skin, points of one lip are not bonded to the other.
  SkinBonder(const TriMesh& bones, const SkinRays& rays, Points normals,
             std::optional<MouthLine> mouth = {});
  // `across`: a sheet's thickness, on one of whose sides lies its skin. What is nearest may be
  // another's: lips touch.
  SkinBond bond(const Vec3& point, const Vec3& across) const;

 private:
  SurfacePoint skin_over(const Vec3& point, const Vec3& across) const;
  bool at_lips(const Vec3& point) const;
  bool of_one_lip(const Vec3& a, const Vec3& b) const;

  const SkinRays& rays_;
  Points normals_;
  std::optional<MouthLine> mouth_;
  NearestSurface surface_, bones_;
};

}  // namespace ecorche::inline v1
