#include "morph/measures/body_volume.h"

namespace ecorche::inline v1 {

double stature(const BodyPackage& package, const Points& points) {
  const auto up = points.col(1).head(package.skin_size);
  return up.maxCoeff() - up.minCoeff();
}

double skin_volume(const BodyPackage& package, const Points& points) {
  const TriMesh capped = capped_skin(package, points);
  double six_volumes = 0;
  for (Eigen::Index f = 0; f < capped.F.rows(); ++f) {
    const Vec3 a = capped.V.row(capped.F(f, 0)), b = capped.V.row(capped.F(f, 1)),
               c = capped.V.row(capped.F(f, 2));
    six_volumes += a.dot(b.cross(c));
  }
  return six_volumes / 6;
}

}  // namespace ecorche::inline v1
