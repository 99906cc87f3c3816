#include "anatomy/queries/ray_crossings.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "anatomy/queries/embree_scene.h"

namespace ecorche::inline v1 {
namespace {

constexpr float kSame = 1e-6f;               // m
constexpr unsigned kMoving = 0, kStill = 1;  // geometries

// What one query hands to the filter.
struct RayCrossingsQuery {
  RTCIntersectContext context;  // first: Embree hands its address back
  const int* labels = nullptr;
  unsigned still = 0;  // the first triangle of those that stay
  int skip = 0;
  float enough = 0;
  std::vector<Crossing>* out = nullptr;
};

// Takes down every triangle that is met and lets the ray go on, but for the one that ends it.
void take_down(const RTCFilterFunctionNArguments* arguments) {
  auto& query = *reinterpret_cast<RayCrossingsQuery*>(arguments->context);
  const auto* ray = reinterpret_cast<const RTCRay*>(arguments->ray);
  const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
  arguments->valid[0] = 0;
  const unsigned triangle = hit->geomID == kStill ? query.still + hit->primID : hit->primID;
  if (query.labels[triangle] == query.skip) return;
  const bool entering =
      hit->Ng_x * ray->dir_x + hit->Ng_y * ray->dir_y + hit->Ng_z * ray->dir_z < 0;
  query.out->push_back({ray->tfar, int(triangle), entering});
  if (entering && ray->tfar > query.enough) arguments->valid[0] = -1;
}

}  // namespace

void find_intervals(std::span<const Crossing> crossings, std::span<const int> solids, double far,
                    std::vector<RayInterval>& intervals) {
  intervals.clear();
  for (const Crossing& crossing : crossings) {
    const int solid = solids[crossing.triangle];
    const double distance = crossing.distance;
    const auto open = std::find_if(intervals.begin(), intervals.end(), [&](const RayInterval& s) {
      return s.solid == solid && s.depth > 0;
    });
    if (crossing.entering) {
      if (open != intervals.end())
        ++open->depth;
      else
        intervals.push_back({solid, distance, far, 1});
    } else if (open != intervals.end()) {
      if (--open->depth == 0) open->to = distance;
    } else {  // it was inside from the beginning
      const auto begun =
          std::find_if(intervals.begin(), intervals.end(),
                       [&](const RayInterval& s) { return s.solid == solid && s.from == 0; });
      if (begun != intervals.end())
        begun->to = distance;
      else
        intervals.push_back({solid, 0, distance, 0});
    }
  }
}

struct CrossingRays::Impl {
  std::vector<int> labels;
  RTCDevice device = nullptr;
  RTCGeometry moving = nullptr;
  RTCScene scene = nullptr;
  Eigen::Index points = 0;  // that move
  unsigned still = 0;       // the first triangle of those that stay

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  RTCGeometry attach(const Points& V, const Triangles& F, RTCBuildQuality quality, unsigned id) {
    const RTCGeometry geometry = triangle_geometry(device, V, F);
    rtcSetGeometryIntersectFilterFunction(geometry, take_down);
    rtcSetGeometryBuildQuality(geometry, quality);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);  // the scene's from now on
    return geometry;
  }

  void commit() const {
    rtcCommitScene(scene);
    check_ray_device(device);
  }
};

CrossingRays::CrossingRays(const Points& V, const Triangles& F, std::vector<int> labels,
                           Eigen::Index moving)
    : impl_(std::make_unique<Impl>()) {
  const auto vertices = V.rows(), faces = F.rows();
  if (faces == 0 || !V.allFinite() || F.minCoeff() < 0 || F.maxCoeff() >= vertices ||
      Eigen::Index(labels.size()) != faces) {
    throw std::invalid_argument(
        fmt::format("CrossingRays: {} vertices, {} triangles, {} labels; expected finite vertices, "
                    "valid indices and a label a triangle",
                    vertices, faces, labels.size()));
  }
  Eigen::Index first = 0;
  while (first < faces && F.row(first).maxCoeff() < moving) ++first;
  if (first == 0 || (first < faces && F.bottomRows(faces - first).minCoeff() < moving))
    throw std::invalid_argument(
        fmt::format("CrossingRays: triangle {} of {} is not where it belongs: those of the {} "
                    "moving points first",
                    first, faces, moving));
  impl_->labels = std::move(labels);
  impl_->points = moving;
  impl_->still = unsigned(first);
  impl_->device = open_ray_device();
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene,
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_LOW);
  impl_->moving =
      impl_->attach(V.topRows(moving), F.topRows(first), RTC_BUILD_QUALITY_REFIT, kMoving);
  if (first < faces)
    impl_->attach(V.bottomRows(vertices - moving),
                  (F.bottomRows(faces - first).array() - int(moving)).matrix(),
                  RTC_BUILD_QUALITY_MEDIUM, kStill);
  impl_->commit();
}

CrossingRays::~CrossingRays() = default;

void CrossingRays::move(const Points& V) {
  if (V.rows() != impl_->points)
    throw std::invalid_argument(
        fmt::format("CrossingRays: {} points for {}", V.rows(), impl_->points));
  place_points(
      V, static_cast<float*>(rtcGetGeometryBufferData(impl_->moving, RTC_BUFFER_TYPE_VERTEX, 0)));
  rtcUpdateGeometryBuffer(impl_->moving, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(impl_->moving);
  impl_->commit();
}

void CrossingRays::cross(const Vec3& origin, const Vec3& direction, double far, double enough,
                         int skip, std::vector<Crossing>& out) const {
  out.clear();
  RTCRayHit ray = ray_from(origin, direction, 0, far);
  RayCrossingsQuery query;
  rtcInitIntersectContext(&query.context);
  query.labels = impl_->labels.data();
  query.still = impl_->still;
  query.skip = skip;
  query.enough = float(enough);
  query.out = &out;
  rtcIntersect1(impl_->scene, &query.context, &ray);
  const float end = ray.ray.tfar;
  std::erase_if(out, [end](const Crossing& c) { return c.distance > end; });
  std::sort(out.begin(), out.end(), [](const Crossing& a, const Crossing& b) {
    return std::tie(a.distance, a.triangle) < std::tie(b.distance, b.triangle);
  });
  std::size_t kept = 0;
  for (const Crossing& c : out) {
    bool again = false;
    for (std::size_t i = kept; i > 0 && out[i - 1].distance >= c.distance - kSame && !again; --i)
      again = out[i - 1].entering == c.entering &&
              impl_->labels[out[i - 1].triangle] == impl_->labels[c.triangle];
    if (!again) out[kept++] = c;
  }
  out.resize(kept);
}

}  // namespace ecorche::inline v1
