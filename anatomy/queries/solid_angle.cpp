#include "anatomy/queries/solid_angle.h"

#include <cmath>

namespace ecorche::inline v1 {

double solid_angle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 pa = a - p, pb = b - p, pc = c - p;
  const double la = pa.norm(), lb = pb.norm(), lc = pc.norm();
  return 2 * std::atan2(pa.dot(pb.cross(pc)),
                        la * lb * lc + pa.dot(pb) * lc + pb.dot(pc) * la + pc.dot(pa) * lb);
}

}  // namespace ecorche::inline v1
