#include "skinning/skin_contact.h"

#include <algorithm>
#include <cmath>

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include "anatomy/errors.h"
#include "skinning/float4.h"
#include "skinning/normals.h"

namespace ecorche {

class ContactTree {
 public:
  explicit ContactTree(std::size_t vertices, std::span<const int> triangles) : device_(rtcNewDevice("")) {
    if (!device_) throw LimitError("the ray tracer could not start: out of memory or threads");
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST));
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);  // keeps a tree of its own for the mesh, which can then be refitted
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    vertices_ = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 4 * sizeof(float), vertices));
    auto* f = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles.size() / 3));
    if (!vertices_ || !f) throw LimitError("out of memory for the ray tracer; try a smaller input or fewer threads");
    std::copy(triangles.begin(), triangles.end(), f);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    rtcAttachGeometry(scene_, geometry);
    geometry_ = geometry;
  }
  ~ContactTree() {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  ContactTree(const ContactTree&) = delete;
  ContactTree& operator=(const ContactTree&) = delete;

  void move(std::span<const float> positions) {
    std::copy(positions.begin(), positions.end(), vertices_);
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
  }

  // Distance to the first triangle along a direction if it is seen from behind; otherwise 0.
  float back_seen(const float* from, Float4 direction, float near, float far) const {
    RTCRayHit ray{};
    ray.ray.org_x = from[0], ray.ray.org_y = from[1], ray.ray.org_z = from[2];
    ray.ray.dir_x = direction[0], ray.ray.dir_y = direction[1], ray.ray.dir_z = direction[2];
    ray.ray.tnear = near;
    ray.ray.tfar = far;
    ray.ray.mask = 0xffffffffu;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return 0;
    const Float4 n{ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z, 0};
    return sum4(n * direction)[0] > 0 ? ray.ray.tfar : 0;
  }

 private:
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  RTCGeometry geometry_ = nullptr;
  float* vertices_ = nullptr;
};

namespace {

constexpr float kSight = 0.5f, kNear = 2e-4f;  // m
constexpr float kGap = 4e-4f;                  // m, that is left between parts
constexpr double kGive = 1;                    // of the tissue
constexpr float kReach = 1;                    // of what a vertex may be pushed: deeper inside, the other side of a thin part would be met
constexpr double kLeastGive = 1e-3;            // m
constexpr int kBlock = 512;

// Half of the way out, and half of the gap. A vertex that is inside another part sees the back of the surface that it came through a little
// way behind it, and some back ahead of it; the near look comes first, as it is short and mostly settles the matter.
Float4 find_push(const ContactTree& tree, const float* place, Float4 normal, float give) {
  const float reach = kReach * give;
  const float depth = tree.back_seen(place, -normal, kNear, reach);
  if (depth <= 0 || tree.back_seen(place, normal, kNear, kSight) <= 0) return Float4{};
  const float fade = std::clamp(2 - 2 * depth / reach, 0.0f, 1.0f);
  return (-0.5f * fade * (depth + std::min(depth, kGap))) * normal;
}

void find_pushes(const ContactTree& tree, std::span<const float> positions, std::span<const float> normals, std::span<const float> give, ContactScratch& s) {
  const int n = static_cast<int>(s.wanted.size());
  tbb::parallel_for(0, (n + kBlock - 1) / kBlock, [&](int block) {
    for (int i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) {
      const std::size_t at = 4 * static_cast<std::size_t>(i);
      const bool look = s.wanted[static_cast<std::size_t>(i)];
      store4(&s.pushes[at], look ? find_push(tree, &positions[at], load4(&normals[at]), give[static_cast<std::size_t>(i)]) : Float4{});
    }
  });
}

// Vertices about those that are pushed follow by a share.
void spread_pushes(const Membrane& rings, std::span<const float> give, ContactScratch& s) {
  constexpr float kShare = 0.6f;
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    for (int i = 0; i < rings.vertex_count; ++i) {
      const std::size_t at = 4 * static_cast<std::size_t>(i);
      Float4 push = load4(&s.pushes[at]);
      if (give[static_cast<std::size_t>(i)] > 0 && rings.first[i + 1] > rings.first[i]) {
        Float4 sum{};
        for (int k = rings.first[i]; k < rings.first[i + 1]; ++k) sum += load4(&s.pushes[4 * static_cast<std::size_t>(rings.neighbour[k])]);
        sum *= kShare / static_cast<float>(rings.first[i + 1] - rings.first[i]);
        if (sum4(sum * sum)[0] > sum4(push * push)[0]) push = sum;
      }
      store4(&s.spread[at], push);
    }
    s.pushes.swap(s.spread);
  }
}

}  // namespace

std::vector<float> contact_give(std::span<const float> positions, std::span<const int> triangles, std::span<const double> tissue) {
  ContactTree tree(positions.size() / 4, triangles);
  tree.move(positions);
  std::vector<float> normals(positions.size()), out(positions.size() / 4);
  vertex_normals(positions, triangles, normals);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool inside = tree.back_seen(&positions[4 * i], load4(&normals[4 * i]), kNear, kSight) > 0;
    out[i] = inside ? 0 : static_cast<float>(kGive * tissue[i] + kLeastGive);
  }
  return out;
}

void part_skin(const Membrane& rings, std::span<const float> give, std::span<const int> triangles, int rounds, std::span<float> positions,
               std::vector<float>& normals, ContactScratch& s) {
  const std::size_t n = positions.size() / 4;
  if (!s.own.tree) s.own.tree = std::make_shared<ContactTree>(n, triangles);
  ContactTree& tree = *s.own.tree;
  s.pushes.resize(4 * n);
  s.spread.resize(4 * n);
  normals.resize(4 * n);
  s.before.assign(positions.begin(), positions.end());
  s.wanted.resize(n);
  for (std::size_t i = 0; i < n; ++i) s.wanted[i] = give[i] > 0;
  for (int round = 0; round < rounds; ++round) {
    vertex_normals(positions, triangles, normals);
    tree.move(positions);
    find_pushes(tree, positions, normals, give, s);
    spread_pushes(rings, give, s);
    bool any = false;
    for (std::size_t i = 0; i < n; ++i) {
      const Float4 push = load4(&s.pushes[4 * i]), start = load4(&s.before[4 * i]);
      s.wanted[i] = sum4(push * push)[0] > 0;
      if (!s.wanted[i]) continue;
      any = true;
      Float4 way = load4(&positions[4 * i]) + push - start;
      const float length = std::sqrt(sum4(way * way)[0]);
      if (length > give[i]) way *= give[i] / length;
      store4(&positions[4 * i], start + way);
    }
    if (!any) break;
  }
}

}  // namespace ecorche
