#include "anatomy/bones/mirror.h"

namespace ecorche::inline v1 {

Vec3 mirror_point(const Vec3& point, double mid_plane) {
  return {2 * mid_plane - point.x(), point.y(), point.z()};
}

std::string mirror_name(const std::string& name) {
  const std::string stem = name.substr(0, name.size() < 2 ? 0 : name.size() - 2);
  if (name.ends_with("_l")) return stem + "_r";
  if (name.ends_with("_r")) return stem + "_l";
  return name;
}

}  // namespace ecorche::inline v1
