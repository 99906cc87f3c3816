#include "morph/skin_rays.h"

#include <embree3/rtcore.h>

#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche {

struct SkinRays::Impl {
  TriMesh mesh;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

SkinRays::SkinRays(const TriMesh& mesh, RayBuild build) : impl_(std::make_unique<Impl>()) {
  const auto vertices = mesh.V.rows(), faces = mesh.F.rows();
  if (faces == 0 || !mesh.V.allFinite() || mesh.F.minCoeff() < 0 || mesh.F.maxCoeff() >= vertices) {
    throw std::invalid_argument(fmt::format("SkinRays: {} vertices, {} triangles; expected finite vertices and valid indices", vertices, faces));
  }
  impl_->mesh = mesh;
  impl_->device = rtcNewDevice("");
  if (!impl_->device) throw LimitError("the ray tracer could not start: out of memory or threads");
  RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                        static_cast<std::size_t>(vertices)));
  auto* f = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                           3 * sizeof(unsigned), static_cast<std::size_t>(faces)));
  if (!v || !f) throw LimitError("out of memory for the ray tracer; try a smaller input or fewer threads");
  Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(v, vertices, 3) = mesh.V.cast<float>();
  Eigen::Map<Eigen::Matrix<unsigned, Eigen::Dynamic, 3, Eigen::RowMajor>>(f, faces, 3) = mesh.F.cast<unsigned>();
  const RTCBuildQuality quality = build == RayBuild::quick ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcCommitGeometry(geometry);
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(impl_->scene, quality);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(impl_->scene);
  if (rtcGetDeviceError(impl_->device) != RTC_ERROR_NONE)
    throw LimitError("out of memory for the ray tracer; try a smaller input or fewer threads");
}

SkinRays::~SkinRays() = default;
SkinRays::SkinRays(SkinRays&&) noexcept = default;
SkinRays& SkinRays::operator=(SkinRays&&) noexcept = default;

const TriMesh& SkinRays::mesh() const { return impl_->mesh; }

RayHit SkinRays::first_hit(const Vec3& origin, const Vec3& direction, double to, double from) const {
  RTCRayHit ray;
  ray.ray.org_x = static_cast<float>(origin.x());
  ray.ray.org_y = static_cast<float>(origin.y());
  ray.ray.org_z = static_cast<float>(origin.z());
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tnear = static_cast<float>(from);
  ray.ray.tfar = static_cast<float>(to);
  ray.ray.time = 0;
  ray.ray.mask = ~0u;
  ray.ray.id = 0;
  ray.ray.flags = 0;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &ray);
  RayHit hit;
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.triangle = static_cast<int>(ray.hit.primID);
  hit.distance = ray.ray.tfar;
  hit.u = ray.hit.u;
  hit.v = ray.hit.v;
  // Embree gives (v1 - v0) x (v2 - v0), outwards for our winding.
  hit.normal = Eigen::Vector3f(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
  hit.normal.normalize();
  hit.facing = hit.normal.dot(Eigen::Vector3f(ray.ray.dir_x, ray.ray.dir_y, ray.ray.dir_z));
  return hit;
}

}  // namespace ecorche
