#include "anatomy/queries/ray_caster.h"

#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/queries/embree_scene.h"

namespace ecorche::inline v1 {

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
    throw std::invalid_argument(fmt::format(
        "SkinRays: {} vertices, {} triangles; expected finite vertices and valid indices", vertices,
        faces));
  }
  impl_->mesh = mesh;
  impl_->device = open_ray_device();
  const RTCGeometry geometry = triangle_geometry(impl_->device, mesh.V, mesh.F);
  const RTCBuildQuality quality =
      build == RayBuild::quick ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcCommitGeometry(geometry);
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(impl_->scene, quality);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(impl_->scene);
  check_ray_device(impl_->device);
}

SkinRays::~SkinRays() = default;
SkinRays::SkinRays(SkinRays&&) noexcept = default;
SkinRays& SkinRays::operator=(SkinRays&&) noexcept = default;

const TriMesh& SkinRays::mesh() const { return impl_->mesh; }

RayHit SkinRays::first_hit(const Vec3& origin, const Vec3& direction, double to,
                           double from) const {
  RTCRayHit ray = ray_from(origin, direction, from, to);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &ray);
  RayHit hit;
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.triangle = int(ray.hit.primID);
  hit.distance = ray.ray.tfar;
  hit.u = ray.hit.u;
  hit.v = ray.hit.v;
  // Embree gives (v1 - v0) x (v2 - v0), outwards for our winding.
  hit.normal = Eigen::Vector3f(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
  hit.normal.normalize();
  hit.facing = hit.normal.dot(Eigen::Vector3f(ray.ray.dir_x, ray.ray.dir_y, ray.ray.dir_z));
  return hit;
}

}  // namespace ecorche::inline v1
