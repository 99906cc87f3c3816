// The mid-plane of the source skeleton, and mirror images across it.
#pragma once

#include <string>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// The source skeleton's plane of symmetry, m.
inline constexpr double kSourceMidPlane = -0.0251;

// The other side of a point, and of a bone, joint or muscle name ("femur_l" -> "femur_r"; unpaired
// names are their own mirror).
Vec3 mirror_point(const Vec3& point, double mid_plane = kSourceMidPlane);
std::string mirror_name(const std::string& name);

}  // namespace ecorche::inline v1
