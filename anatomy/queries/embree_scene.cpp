#include "anatomy/queries/embree_scene.h"

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

constexpr const char* kFull =
    "out of memory for the ray tracer; try a smaller input or fewer threads";

}  // namespace

RTCDevice open_ray_device() {
  const RTCDevice device = rtcNewDevice("");
  if (!device) throw LimitError("the ray tracer could not start: out of memory or threads");
  return device;
}

void place_points(const Points& V, float* buffer) {
  Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(buffer, V.rows(), 3) =
      V.cast<float>();
}

RTCGeometry triangle_geometry(RTCDevice device, const Points& V, const Triangles& F) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                        RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                        std::size_t(V.rows())));
  auto* f = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                           RTC_FORMAT_UINT3, 3 * sizeof(unsigned),
                                                           std::size_t(F.rows())));
  if (!v || !f) {
    rtcReleaseGeometry(geometry);
    throw LimitError(kFull);
  }
  place_points(V, v);
  Eigen::Map<Eigen::Matrix<unsigned, Eigen::Dynamic, 3, Eigen::RowMajor>>(f, F.rows(), 3) =
      F.cast<unsigned>();
  return geometry;
}

void check_ray_device(RTCDevice device) {
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw LimitError(kFull);
}

RTCRayHit ray_from(const Vec3& origin, const Vec3& direction, double from, double to) {
  RTCRayHit ray;
  ray.ray.org_x = float(origin.x());
  ray.ray.org_y = float(origin.y());
  ray.ray.org_z = float(origin.z());
  ray.ray.dir_x = float(direction.x());
  ray.ray.dir_y = float(direction.y());
  ray.ray.dir_z = float(direction.z());
  ray.ray.tnear = float(from);
  ray.ray.tfar = float(to);
  ray.ray.time = 0;
  ray.ray.mask = ~0u;
  ray.ray.id = 0;
  ray.ray.flags = 0;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

}  // namespace ecorche::inline v1
