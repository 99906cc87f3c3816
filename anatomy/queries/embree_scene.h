// What the ray tracers of this room have in common. Private to their .cpp files.
#pragma once

#include <embree3/rtcore.h>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// All throw LimitError when memory or threads run out.
RTCDevice open_ray_device();
RTCGeometry triangle_geometry(RTCDevice device, const Points& V,
                              const Triangles& F);  // not committed yet; the caller's to release
void place_points(const Points& V, float* buffer);  // of its vertices
void check_ray_device(RTCDevice device);

RTCRayHit ray_from(const Vec3& origin, const Vec3& direction, double from, double to);

}  // namespace ecorche::inline v1
