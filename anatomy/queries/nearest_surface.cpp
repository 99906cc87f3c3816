#include "anatomy/queries/nearest_surface.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {

struct NearestSurface::Scene {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  TriMesh mesh;

  ~Scene() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {

struct Query {
  const TriMesh* mesh;
  Vec3 p;
  double best2;  // squared distance of the best so far
  SurfacePoint out;
};

// Whether triangle f is nearer than the best so far, which it then becomes.
bool improve(Query& query, int f) {
  const TriMesh& mesh = *query.mesh;
  const Vec3 q = nearest_in_triangle(query.p, mesh.V.row(mesh.F(f, 0)), mesh.V.row(mesh.F(f, 1)),
                                     mesh.V.row(mesh.F(f, 2)));
  const double d2 = (q - query.p).squaredNorm();
  if (d2 > query.best2 || (d2 == query.best2 && query.out.triangle >= 0 && f > query.out.triangle))
    return false;
  query.best2 = d2;
  query.out = {f, std::sqrt(d2), q};
  return true;
}

// The margin covers the rounding of coordinates to float (2 m: 1.2e-7).
float search_radius(double distance) { return float(distance * (1 + 1e-6) + 1e-6); }

bool visit(RTCPointQueryFunctionArguments* args) {
  Query& query = *static_cast<Query*>(args->userPtr);
  if (!improve(query, int(args->primID))) return false;
  args->query->radius = search_radius(query.out.distance);
  return true;
}

void find_nearest(RTCScene scene, float radius, Query& query) {
  RTCPointQuery sphere{float(query.p.x()), float(query.p.y()), float(query.p.z()), 0.0f, radius};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene, &sphere, &context, visit, &query);
}

RTCRayHit make_ray(const Vec3& origin, const Vec3& direction, double far_limit) {
  RTCRayHit ray{};
  ray.ray.org_x = float(origin.x()), ray.ray.org_y = float(origin.y()),
  ray.ray.org_z = float(origin.z());
  ray.ray.dir_x = float(direction.x()), ray.ray.dir_y = float(direction.y()),
  ray.ray.dir_z = float(direction.z());
  ray.ray.tnear = 0;
  ray.ray.tfar = float(far_limit);
  ray.ray.mask = 0xffffffffu;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

}  // namespace

Vec3 nearest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return a + ab * (d1 / (d1 - d3));
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double length2 = (d4 - d3) + (d5 - d6);
    return b + (c - b) * (length2 > 0 ? (d4 - d3) / length2 : 0);
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return a;
  return a + ab * (vb / sum) + ac * (vc / sum);
}

NearestSurface::NearestSurface(const TriMesh& mesh) : scene_(std::make_unique<Scene>()) {
  if (mesh.F.rows() == 0) throw std::invalid_argument("NearestSurface: a mesh without triangles");
  if (mesh.F.minCoeff() < 0 || mesh.F.maxCoeff() >= mesh.V.rows())
    throw std::invalid_argument("NearestSurface: index out of range");
  if (!mesh.V.allFinite())
    throw std::invalid_argument("NearestSurface: a coordinate is not finite");
  scene_->mesh = mesh;
  scene_->device = rtcNewDevice("threads=1");
  if (!scene_->device) throw LimitError("the ray tracer could not start: out of memory or threads");
  scene_->scene = rtcNewScene(scene_->device);
  rtcSetSceneFlags(scene_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene_->scene, RTC_BUILD_QUALITY_MEDIUM);
  const RTCGeometry geometry = rtcNewGeometry(scene_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                        RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                        std::size_t(mesh.V.rows())));
  auto* t = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                           RTC_FORMAT_UINT3, 3 * sizeof(unsigned),
                                                           std::size_t(mesh.F.rows())));
  if (!v || !t)
    throw LimitError("out of memory for the ray tracer; try a smaller input or fewer threads");
  for (Eigen::Index i = 0; i < mesh.V.size(); ++i) v[i] = float(mesh.V.data()[i]);
  for (Eigen::Index i = 0; i < mesh.F.size(); ++i) t[i] = unsigned(mesh.F.data()[i]);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_->scene);
  if (rtcGetDeviceError(scene_->device) != RTC_ERROR_NONE)
    throw LimitError("out of memory for the ray tracer; try a smaller input or fewer threads");
}

NearestSurface::~NearestSurface() = default;

SurfacePoint NearestSurface::nearest(const Vec3& p, int hint) const {
  Query query{&scene_->mesh, p, std::numeric_limits<double>::infinity(), {}};
  float radius = std::numeric_limits<float>::infinity();
  if (hint >= 0 && hint < scene_->mesh.F.rows() && improve(query, hint))
    radius = search_radius(query.out.distance);
  find_nearest(scene_->scene, radius, query);
  return query.out;
}

std::optional<SurfacePoint> NearestSurface::nearest_within(const Vec3& p, double distance) const {
  Query query{&scene_->mesh, p, distance * distance, {}};
  find_nearest(scene_->scene, search_radius(distance), query);
  if (query.out.triangle < 0) return std::nullopt;
  return query.out;
}

bool NearestSurface::blocked(const Vec3& from, const Vec3& to) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit ray = make_ray(from, to - from, 1.0);
  rtcOccluded1(scene_->scene, &context, &ray.ray);
  return ray.ray.tfar < 0;
}

std::optional<double> NearestSurface::cast(const Vec3& origin, const Vec3& direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit ray = make_ray(origin, direction, std::numeric_limits<double>::infinity());
  rtcIntersect1(scene_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return ray.ray.tfar;
}

}  // namespace ecorche::inline v1
