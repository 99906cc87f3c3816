#include "morph/dilation/tissue_stretch.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "anatomy/geometry/join_meshes.h"

namespace ecorche::inline v1 {

namespace {

// m: one sample of the skin in a cube of this size. Larger: coarser; smaller: more rays.
constexpr double kSpacing = 0.012;
constexpr double kCell = 0.04;  // m: of the search grid; speed only
// m: of the smooth mean over samples. Larger: muscles miss the layer where it is uneven; smaller:
// neighbours are stretched unevenly.
constexpr double kReach = 0.022;
// m below the skin: where no bone lies nearer, tissue is stretched from here.
constexpr double kDeepestTissueStretch = 0.16;
constexpr double kAbove = 0.04;  // m: rays start above the skin, for muscles that protrude
// Least room for muscle as a fraction of the bone's depth: where the bone is near, the layer is
// taken as thinner. Larger: muscles protrude into the layer; smaller: they vanish over near bone.
constexpr double kLeastRoom = 0.6;
// Bounds of the stretch. Wider: sections next to noise of the samples are distorted; narrower:
// muscles do not reach the layer of very lean or very fat bodies.
constexpr double kLeastStretch = 0.4, kMostStretch = 1.9;
constexpr double kMostShift = 0.05;  // m, bound of the shift; as above
constexpr int kTubeSides = 10;

// One vertex of the skin a cube of kSpacing: the one nearest to its middle. Cubes lie about the
// middle of the body, so that a body moved or mirrored is sampled at the same vertices.
std::vector<Eigen::Index> sample_vertices(const Points& V, const std::vector<Vec3>& normals) {
  struct Best {
    Eigen::Index vertex;
    double squared;
  };
  const Vec3 low = V.colwise().minCoeff(), high = V.colwise().maxCoeff();
  const Vec3 origin((low.x() + high.x()) / 2, low.y(), (low.z() + high.z()) / 2);
  constexpr double kOnPlane = 1e-6;  // m
  std::unordered_map<long long, Best> cubes;
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    if (normals[i].squaredNorm() == 0) continue;  // a vertex without triangles
    Vec3 p = V.row(i).transpose() - origin;
    const long long side = std::abs(p.x()) < kOnPlane ? 0 : p.x() < 0 ? 1 : 2;
    p.x() = std::abs(p.x());
    const Vec3 cube = (p / kSpacing).array().floor();
    const auto index = [&](int axis) { return static_cast<long long>(cube[axis]) + (1 << 18); };
    const double squared = (p / kSpacing - cube - Vec3::Constant(0.5)).squaredNorm();
    const auto [at, fresh] = cubes.try_emplace(
        side << 60 | index(0) << 40 | index(1) << 20 | index(2), Best{i, squared});
    if (!fresh && squared < at->second.squared - 1e-9) at->second = {i, squared};
  }
  std::vector<Eigen::Index> chosen;
  for (const auto& [key, best] : cubes) chosen.push_back(best.vertex);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

// Strips as open tubes of few sides.
TriMesh muscle_tubes(std::span<const Ellipse> slices,
                     std::span<const std::pair<int, int>> stretches) {
  const auto strips = Eigen::Index(stretches.size());
  Eigen::Index count = 0;
  for (const auto& [begin, end] : stretches) count += end - begin;
  std::array<std::pair<double, double>, kTubeSides> circle;
  for (int i = 0; i < kTubeSides; ++i)
    circle[i] = {std::cos(6.283185307179586 * i / kTubeSides),
                 std::sin(6.283185307179586 * i / kTubeSides)};
  TriMesh mesh{Points(count * kTubeSides, 3), Triangles(2 * (count - strips) * kTubeSides, 3)};
  Eigen::Index v = 0, f = 0;
  for (const auto& [begin, end] : stretches) {
    for (int k = begin; k < end; ++k) {
      const Ellipse& e = slices[k];
      const Vec3 width = e.radii.x() * e.axes.col(0), thickness = e.radii.y() * e.axes.col(1);
      for (int i = 0; i < kTubeSides; ++i, ++v) {
        mesh.V.row(v) = e.center + circle[i].first * width + circle[i].second * thickness;
        if (k == begin) continue;
        const int here = int(v), next = i + 1 < kTubeSides ? here + 1 : here + 1 - kTubeSides;
        mesh.F.row(f++) << here - kTubeSides, next - kTubeSides, next;
        mesh.F.row(f++) << here - kTubeSides, next, here;
      }
    }
  }
  return mesh;
}

// Joints fall into regions: each joint is one, but the trunk, the neck and the shoulder girdle are
// one together.
std::vector<int> joint_regions(const Skeleton& skeleton) {
  std::vector<int> regions(skeleton.joints.size());
  for (std::size_t j = 0; j < regions.size(); ++j) {
    const std::string& name = skeleton.joints[j].name;
    const bool limb = name.ends_with("_l") || name.ends_with("_r");
    const bool girdle = name.starts_with("clavicle") || name.starts_with("scapula");
    regions[j] = limb && !girdle ? int(j) : 0;
  }
  return regions;
}

// The regions between the joints that a muscle's path rides on.
std::vector<char> regions_of(const Muscle& muscle, const Skeleton& skeleton,
                             const std::vector<int>& regions) {
  std::vector<char> on_path(skeleton.joints.size(), 0);
  const auto chain = [&](int j) {
    std::vector<int> up;
    for (; j >= 0; j = skeleton.joints[j].parent) up.push_back(j);
    return up;
  };
  std::vector<int> shared;  // ancestors of all joints so far
  bool first = true;
  for (const Strip& strip : muscle.strips) {
    for (const PathPoint& point : strip.path) {
      for (const int j : point.joints) {
        if (j < 0) continue;
        const std::vector<int> up = chain(j);
        for (const int a : up) on_path[a] = 1;
        if (first) shared = up;
        std::erase_if(shared,
                      [&](int a) { return std::find(up.begin(), up.end(), a) == up.end(); });
        first = false;
      }
    }
  }
  // What lies above the nearest joint that all of them share is not between them.
  for (std::size_t k = 1; k < shared.size(); ++k) on_path[shared[k]] = 0;
  std::vector<char> concerned(regions.size(), 0);
  for (std::size_t j = 0; j < on_path.size(); ++j) {
    if (on_path[j]) concerned[regions[j]] = 1;
  }
  return concerned;
}

// All bones but those of the hands, which hold most of the triangles and little flesh.
TriMesh large_bones(const Anatomy& anatomy, std::vector<int>& joints) {
  std::vector<const TriMesh*> kept;
  for (const Bone& bone : anatomy.bones) {
    if (bone.mesh.F.rows() > 1500 && bone.side != Side::middle) continue;
    kept.push_back(&bone.mesh);
    joints.insert(joints.end(), std::size_t(bone.mesh.F.rows()), bone.joint);
  }
  return join_meshes(kept);
}

}  // namespace

TissueStretch::TissueStretch(const Anatomy& anatomy, const SkinRays& rays, const FatLayer& fat) {
  const TriMesh& skin = rays.mesh();
  std::vector<Vec3> normals(skin.V.rows(), Vec3::Zero());
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    const Vec3 a = skin.V.row(skin.F(f, 0)), b = skin.V.row(skin.F(f, 1)),
               c = skin.V.row(skin.F(f, 2));
    for (int k = 0; k < 3; ++k) normals[skin.F(f, k)] += (b - a).cross(c - a);
  }
  const std::vector<Eigen::Index> chosen = sample_vertices(skin.V, normals);
  int at = 0;
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) {
      const int begin = at;
      at += int(strip.slices.size());
      if (!lies_in_fat(muscle)) strips_.emplace_back(begin, at);
    }
  std::vector<int> joint_of_face;
  const TriMesh bones = large_bones(anatomy, joint_of_face);
  const std::vector<int> regions = joint_regions(anatomy.skeleton);
  for (const Muscle& muscle : anatomy.muscles)
    concerns_.push_back(regions_of(muscle, anatomy.skeleton, regions));
  if (bones.F.rows() == 0) return;
  const SkinRays bone_rays(bones, RayBuild::quick);
  samples_.resize(chosen.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chosen.size(), 256), [&](const auto& range) {
    for (std::size_t s = range.begin(); s < range.end(); ++s) {
      Sample& sample = samples_[s];
      sample.position = skin.V.row(chosen[s]);
      sample.normal = normals[chosen[s]].normalized();
      // The flesh of one side of a limb ends half way to the other side.
      const RayHit through =
          rays.first_hit(sample.position, -sample.normal, 2 * kDeepestTissueStretch, 1e-3);
      const double deepest = through.triangle >= 0 ? through.distance / 2 : kDeepestTissueStretch;
      const RayHit bone = bone_rays.first_hit(sample.position, -sample.normal, deepest);
      sample.bone = bone.triangle >= 0 ? bone.distance : deepest;
      if (bone.triangle >= 0) {
        const int joint = joint_of_face[bone.triangle];
        sample.region = regions[joint];
      }
      const double layer = fat.thickness[chosen[s]];
      sample.layer = std::min(layer, (1 - kLeastRoom) * sample.bone);
      sample.room = sample.bone - sample.layer;
    }
  });
  rays_ = 2 * static_cast<long long>(samples_.size());
  sort_into_cells();
}

void TissueStretch::sort_into_cells() {
  Vec3 low = samples_.front().position, high = low;
  for (const Sample& sample : samples_) {
    low = low.cwiseMin(sample.position);
    high = high.cwiseMax(sample.position);
  }
  corner_ = low;
  size_ = ((high - low).array() / kCell).floor().cast<int>() + 1;
  const auto cell = [&](const Sample& sample) {
    const Eigen::Array3i at = ((sample.position - corner_).array() / kCell).floor().cast<int>();
    return (at.x() * size_.y() + at.y()) * size_.z() + at.z();
  };
  std::stable_sort(samples_.begin(), samples_.end(),
                   [&](const Sample& a, const Sample& b) { return cell(a) < cell(b); });
  cell_begin_.assign(std::size_t(size_.prod()) + 1, 0);
  for (const Sample& sample : samples_) ++cell_begin_[cell(sample) + 1];
  for (std::size_t k = 1; k < cell_begin_.size(); ++k) cell_begin_[k] += cell_begin_[k - 1];
}

void TissueStretch::look_at(std::span<const Ellipse> slices) {
  if (samples_.empty() || slices.size() < 2) return;
  if (strips_.empty()) return;  // no muscle says how tall the flesh is
  const SkinRays muscle_rays(muscle_tubes(slices, strips_), RayBuild::quick);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, samples_.size(), 256), [&](const auto& range) {
        for (std::size_t s = range.begin(); s < range.end(); ++s) {
          Sample& sample = samples_[s];
          const RayHit muscle = muscle_rays.first_hit(sample.position + kAbove * sample.normal,
                                                      -sample.normal, kAbove + sample.bone);
          sample.height = muscle.triangle >= 0 ? sample.bone - (muscle.distance - kAbove) : 0;
          // Thin flesh says little about the stretch; a muscle that begins in the deeper half is
          // not the one that fills this place.
          sample.weight = sample.height > 0.3 * sample.room ? 1 : 0;
        }
      });
  rays_ += static_cast<long long>(samples_.size());
}

void TissueStretch::collect(const Vec3& point, double radius, const std::vector<char>& concerns,
                            std::vector<Near>& found) const {
  found.clear();
  const auto cell = [&](const Vec3& p) -> Eigen::Array3i {
    return ((p - corner_).array() / kCell).floor().cast<int>();
  };
  const Eigen::Array3i low = cell(point.array() - radius).max(0),
                       high = cell(point.array() + radius).min(size_ - 1);
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      const int column = (x * size_.y() + y) * size_.z();
      if (low.z() > high.z()) continue;
      for (int s = cell_begin_[column + low.z()]; s < cell_begin_[column + high.z() + 1]; ++s) {
        const Sample& sample = samples_[s];
        const double squared = (sample.position - point).squaredNorm();
        if (squared >= radius * radius) continue;
        if (sample.region < 0 || concerns[sample.region]) found.push_back({&sample, squared});
      }
    }
  }
}

TissuePull TissueStretch::at(const Vec3& point, int muscle) const {
  if (samples_.empty()) return {};
  std::vector<Near> near;
  near.reserve(128);
  double radius = 0.05;
  while (radius < 0.17) {
    collect(point, radius, concerns_[muscle], near);
    if (near.size() >= 24) break;
    radius += 0.03;
  }
  double nearest = 1e9;
  for (const Near& n : near) nearest = std::min(nearest, n.squared);
  Vec3 outwards = Vec3::Zero();
  double weights = 0, depth = 0, layer = 0, used = 0, bone = 0, gap = 0, height = 0;
  for (const auto& [s, squared] : near) {
    const Vec3 to_skin = s->position - point;
    const double w = std::exp(-(squared - nearest) / (2 * kReach * kReach));
    weights += w;
    outwards += w * s->normal;
    depth += w * to_skin.dot(s->normal);
    layer += w * s->layer;
    used += w * s->weight;
    bone += w * s->weight * s->bone;
    gap += w * s->weight * (s->room - s->height);
    height += w * s->weight * s->height;
  }
  TissuePull pull;
  if (weights <= 0 || used < 0.05 * weights || outwards.norm() < 1e-9) return pull;
  pull.outwards = outwards.normalized();
  pull.free = (depth - layer) / weights;
  const double top = std::clamp(gap / used, -kMostShift, kMostShift), tall = height / used;
  const double above = bone / used - depth / weights;  // of this point over the bone
  pull.shift = top * std::clamp(above / tall, 0.0, 1.0);
  pull.height = above;
  pull.tall = tall;
  pull.room = tall + top;
  pull.stretch = std::clamp(1 + top / tall, kLeastStretch, kMostStretch);
  return pull;
}

}  // namespace ecorche::inline v1
