#include "skinning/muscle_collision/bone_probes.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kNear = 0.030;     // m below the skin at rest; deeper points get no probe
constexpr float kMargin = 1.5e-3f;  // m, that probes stay below the skin
constexpr float kInCavity = 1e-3f;  // m out of the skin at rest: in the mouth, as teeth are
constexpr int kProbesEach = 4;      // of a joint and a vertex of the skin
constexpr std::size_t kBlock = 1024;

struct Candidate {
  BoneProbe probe;
  double depth = std::numeric_limits<double>::infinity();  // m, at rest; of those not near
};

// The points of a bone that are near the skin at rest.
std::vector<Candidate> candidates_of(const Bone& bone, const Vec3& joint, const TriMesh& skin,
                                     const NearestSurface& nearest) {
  std::vector<Candidate> all(bone.mesh.V.rows());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    const Vec3 p = bone.mesh.V.row(i);
    if (const std::optional<SurfacePoint> hit = nearest.nearest_within(p, kNear))
      all[i] = {{bone.joint, (p - joint).cast<float>(), nearest_vertex(skin, *hit, p)},
                hit->distance};
  });
  std::erase_if(all, [](const Candidate& c) { return std::isinf(c.depth); });
  return all;
}

// Up to eight probes on their way to be projected.
struct Waiting {
  std::array<float, 8> x, y, z;  // relative to the vertices
  std::array<int, 8> vertex;
  std::array<float, 8> margin;
  std::size_t count = 0;

  void add(const BoneProbe& probe, const Eigen::Vector3f& p) {
    x[count] = p.x(), y[count] = p.y(), z[count] = p.z();
    vertex[count] = probe.vertex;
    margin[count++] = probe.margin;
  }

  SkinProjections project(const SkinRings& rings, const PosedSkin& skin) {
    for (std::size_t k = count; k < 8; ++k) {  // the first one fills up
      x[k] = x[0], y[k] = y[0], z[k] = z[0];
      vertex[k] = vertex[0];
    }
    return project_to_skin(rings, skin, {load8(x.data()), load8(y.data()), load8(z.data())},
                           vertex);
  }
};

// At rest no probe is nearer to the skin than its margin.
void set_margins(const TriMesh& skin, std::span<const Vec3> joints, const SkinRings& rings,
                 std::span<BoneProbe> probes) {
  const StillSkin still = make_still_skin(skin);
  tbb::parallel_for(std::size_t{0}, (probes.size() + 7) / 8, [&](std::size_t eight) {
    const std::span<BoneProbe> some =
        probes.subspan(8 * eight, std::min<std::size_t>(8, probes.size() - 8 * eight));
    Waiting waiting;
    for (const BoneProbe& probe : some) {
      const Vec3 vertex = skin.V.row(probe.vertex);
      waiting.add(probe, probe.place + (joints[probe.joint] - vertex).cast<float>());
    }
    const SkinProjections projections = waiting.project(rings, {still.positions, still.normals});
    for (std::size_t k = 0; k < some.size(); ++k)
      some[k].margin = std::min(kMargin, -projections.height[int(k)] - 1e-5f);
  });
}

}  // namespace

std::vector<BoneProbe> place_bone_probes(const Anatomy& anatomy, const TriMesh& skin,
                                         const SkinRings& rings) {
  const NearestSurface nearest(skin);
  const std::vector<Vec3> joints = rest_positions(anatomy.skeleton);
  std::vector<Candidate> all;
  for (const Bone& bone : anatomy.bones) {
    const std::vector<Candidate> some = candidates_of(bone, joints[bone.joint], skin, nearest);
    all.insert(all.end(), some.begin(), some.end());
  }
  std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
    return std::pair(std::pair(a.probe.joint, a.probe.vertex), a.depth) <
           std::pair(std::pair(b.probe.joint, b.probe.vertex), b.depth);
  });
  std::vector<BoneProbe> out;
  int same = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const BoneProbe& probe = all[k].probe;
    same = k > 0 && probe.joint == all[k - 1].probe.joint && probe.vertex == all[k - 1].probe.vertex
               ? same + 1
               : 0;
    if (same < kProbesEach) out.push_back(probe);
  }
  set_margins(skin, joints, rings, out);
  std::erase_if(out, [](const BoneProbe& probe) { return probe.margin < -kInCavity; });
  return out;
}

void find_bone_penetrations(std::span<const BoneProbe> probes, std::span<const Transform> X_WJ,
                            const SkinRings& rings, const PosedSkin& skin,
                            std::vector<std::vector<SkinPenetration>>& blocks,
                            std::vector<SkinPenetration>& out) {
  blocks.resize((probes.size() + kBlock - 1) / kBlock);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    std::vector<SkinPenetration>& found = blocks[b];
    found.clear();
    Waiting waiting;
    const auto finish = [&] {
      const SkinProjections projections = waiting.project(rings, skin);
      for (std::size_t k = 0; k < waiting.count; ++k) {
        const float depth = projections.height[int(k)] + waiting.margin[k];
        if (depth > 0) found.push_back({projections.vertex[k], depth});
      }
      waiting.count = 0;
    };
    int joint = -1;
    Eigen::Matrix3f turn = Eigen::Matrix3f::Identity();
    Vec3 origin = Vec3::Zero();
    for (const BoneProbe& probe :
         probes.subspan(b * kBlock, std::min(kBlock, probes.size() - b * kBlock))) {
      if (probe.joint != joint) {
        joint = probe.joint;
        turn = X_WJ[joint].linear().cast<float>();
        origin = X_WJ[joint].translation();
      }
      const std::size_t v = 4 * std::size_t(probe.vertex);
      const Vec3 vertex(skin.positions[v], skin.positions[v + 1], skin.positions[v + 2]);
      const Eigen::Vector3f p = turn * probe.place + (origin - vertex).cast<float>();
      const float height = p.dot(Eigen::Map<const Eigen::Vector3f>(&skin.normals[v]));
      const float aside = std::max(kAside, -kAsideDepths * height);
      if (height < -kDeepProjection && p.squaredNorm() - height * height < aside * aside) continue;
      waiting.add(probe, p);
      if (waiting.count == 8) finish();
    }
    if (waiting.count > 0) finish();
  });
  out.clear();
  for (const std::vector<SkinPenetration>& found : blocks)
    out.insert(out.end(), found.begin(), found.end());
}

}  // namespace ecorche::inline v1
