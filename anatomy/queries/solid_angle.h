// How large a triangle is seen: what winding numbers are sums of.
#pragma once

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Of the triangle a b c as seen from p, steradians; positive from behind its front. After van
// Oosterom & Strackee 1983.
double solid_angle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace ecorche::inline v1
