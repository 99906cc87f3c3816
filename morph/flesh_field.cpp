#include "morph/flesh_field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "anatomy/muscle_line.h"

namespace ecorche {

namespace {

constexpr double kSpacing = 0.012;      // m: one sample a cube of this size
constexpr double kCell = 0.04;          // m: of the search grid
constexpr double kReach = 0.022;        // m: of the smooth mean
constexpr double kDeepest = 0.12;       // m: where no bone lies nearer, flesh is stretched from here
constexpr double kAbove = 0.04;         // m: rays start above the skin, for muscles that stand out of it
constexpr double kLeastRoom = 0.6;      // of the bone's depth: where the bone is near, the layer is thinner
constexpr double kLeastStretch = 0.4, kMostStretch = 1.9;
constexpr double kMostShift = 0.025;    // m
constexpr int kTubeSides = 10;

long long cell_of(const Vec3& p, double size) {
  const auto index = [&](double x) { return static_cast<long long>(std::floor(x / size)) + (1 << 19); };
  return (index(p.x()) << 40) | (index(p.y()) << 20) | index(p.z());
}

// All muscles as open tubes of few sides.
TriMesh muscle_tubes(const Anatomy& anatomy) {
  const int slices = slice_count(anatomy);
  TriMesh mesh{Points(slices * kTubeSides, 3), Triangles(2 * slices * kTubeSides, 3)};
  Eigen::Index v = 0, f = 0;
  for (const Muscle& muscle : anatomy.muscles) {
    for (const Strip& strip : muscle.strips) {
      const std::vector<Ellipse> ellipses = rest_slices(strip);
      for (std::size_t k = 0; k < ellipses.size(); ++k) {
        const Ellipse& e = ellipses[k];
        for (int i = 0; i < kTubeSides; ++i, ++v) {
          const double angle = 6.283185307179586 * i / kTubeSides;
          mesh.V.row(v) = e.center + e.radii.x() * std::cos(angle) * e.axes.col(0) + e.radii.y() * std::sin(angle) * e.axes.col(1);
          if (k == 0) continue;
          const int here = static_cast<int>(v), next = i + 1 < kTubeSides ? here + 1 : here + 1 - kTubeSides;
          mesh.F.row(f++) << here - kTubeSides, next - kTubeSides, next;
          mesh.F.row(f++) << here - kTubeSides, next, here;
        }
      }
    }
  }
  mesh.F.conservativeResize(f, 3);
  return mesh;
}

// Joints fall into regions: each joint is one, but the trunk, the neck and the shoulder girdle are one together.
std::vector<int> joint_regions(const Skeleton& skeleton) {
  std::vector<int> regions(skeleton.joints.size());
  for (std::size_t j = 0; j < regions.size(); ++j) {
    const std::string& name = skeleton.joints[j].name;
    const bool limb = name.ends_with("_l") || name.ends_with("_r");
    const bool girdle = name.starts_with("clavicle") || name.starts_with("scapula");
    regions[j] = limb && !girdle ? static_cast<int>(j) : 0;
  }
  return regions;
}

// The regions between the joints that a muscle's path rides on.
std::vector<char> regions_of(const Muscle& muscle, const Skeleton& skeleton, const std::vector<int>& regions) {
  std::vector<char> on_path(skeleton.joints.size(), 0);
  const auto chain = [&](int j) {
    std::vector<int> up;
    for (; j >= 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent) up.push_back(j);
    return up;
  };
  std::vector<int> shared;  // ancestors of all joints so far
  bool first = true;
  for (const Strip& strip : muscle.strips) {
    for (const PathPoint& point : strip.path) {
      for (const int j : point.joints) {
        if (j < 0) continue;
        const std::vector<int> up = chain(j);
        for (const int a : up) on_path[static_cast<std::size_t>(a)] = 1;
        if (first) shared = up;
        std::erase_if(shared, [&](int a) { return std::find(up.begin(), up.end(), a) == up.end(); });
        first = false;
      }
    }
  }
  // What lies above the nearest joint that all of them share is not between them.
  for (std::size_t k = 1; k < shared.size(); ++k) on_path[static_cast<std::size_t>(shared[k])] = 0;
  std::vector<char> concerned(regions.size(), 0);
  for (std::size_t j = 0; j < on_path.size(); ++j) {
    if (on_path[j]) concerned[static_cast<std::size_t>(regions[j])] = 1;
  }
  return concerned;
}

// All bones but those of the hands, which hold most of the triangles and little flesh.
TriMesh large_bones(const Anatomy& anatomy, std::vector<int>& joints) {
  std::vector<const TriMesh*> kept;
  Eigen::Index vertices = 0, faces = 0;
  for (const Bone& bone : anatomy.bones) {
    if (bone.mesh.F.rows() > 1500 && bone.side != Side::middle) continue;
    kept.push_back(&bone.mesh);
    joints.insert(joints.end(), static_cast<std::size_t>(bone.mesh.F.rows()), bone.joint);
    vertices += bone.mesh.V.rows();
    faces += bone.mesh.F.rows();
  }
  TriMesh all{Points(vertices, 3), Triangles(faces, 3)};
  Eigen::Index v = 0, f = 0;
  for (const TriMesh* mesh : kept) {
    all.V.middleRows(v, mesh->V.rows()) = mesh->V;
    all.F.middleRows(f, mesh->F.rows()) = mesh->F.array() + static_cast<int>(v);
    v += mesh->V.rows();
    f += mesh->F.rows();
  }
  return all;
}

}  // namespace

FleshField::FleshField(const Anatomy& anatomy, const SkinRays& rays, const FatLayer& fat) {
  const TriMesh& skin = rays.mesh();
  std::vector<Vec3> normals(static_cast<std::size_t>(skin.V.rows()), Vec3::Zero());
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    const Vec3 a = skin.V.row(skin.F(f, 0)), b = skin.V.row(skin.F(f, 1)), c = skin.V.row(skin.F(f, 2));
    for (int k = 0; k < 3; ++k) normals[static_cast<std::size_t>(skin.F(f, k))] += (b - a).cross(c - a);
  }
  std::vector<Eigen::Index> chosen;
  std::unordered_set<long long> taken;
  for (Eigen::Index i = 0; i < skin.V.rows(); ++i) {
    if (normals[static_cast<std::size_t>(i)].squaredNorm() == 0) continue;  // a vertex without triangles
    if (taken.insert(cell_of(skin.V.row(i), kSpacing)).second) chosen.push_back(i);
  }
  std::vector<int> joint_of_face;
  const TriMesh tubes = muscle_tubes(anatomy), bones = large_bones(anatomy, joint_of_face);
  const std::vector<int> regions = joint_regions(anatomy.skeleton);
  for (const Muscle& muscle : anatomy.muscles) concerns_.push_back(regions_of(muscle, anatomy.skeleton, regions));
  if (tubes.F.rows() == 0 || bones.F.rows() == 0) return;
  const SkinRays muscle_rays(tubes), bone_rays(bones);
  samples_.resize(chosen.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chosen.size(), 256), [&](const auto& range) {
    for (std::size_t s = range.begin(); s < range.end(); ++s) {
      Sample& sample = samples_[s];
      sample.position = skin.V.row(chosen[s]);
      sample.normal = normals[static_cast<std::size_t>(chosen[s])].normalized();
      const Vec3 above = sample.position + kAbove * sample.normal;
      // The flesh of one side of a limb ends half way to the other side.
      const RayHit through = rays.first_hit(sample.position, -sample.normal, 2 * kDeepest, 1e-3);
      const double deepest = through.triangle >= 0 ? through.distance / 2 : kDeepest;
      const RayHit bone = bone_rays.first_hit(sample.position, -sample.normal, deepest);
      sample.bone = bone.triangle >= 0 ? bone.distance : deepest;
      if (bone.triangle >= 0) {
        const int joint = joint_of_face[static_cast<std::size_t>(bone.triangle)];
        sample.region = regions[static_cast<std::size_t>(joint)];
      }
      const RayHit muscle = muscle_rays.first_hit(above, -sample.normal, kAbove + sample.bone);
      const double layer = fat.thickness[static_cast<std::size_t>(chosen[s])];
      sample.layer = std::min(layer, (1 - kLeastRoom) * sample.bone);
      sample.room = sample.bone - sample.layer;
      sample.height = muscle.triangle >= 0 ? sample.bone - (muscle.distance - kAbove) : 0;
      // Thin flesh says little about the stretch; a muscle that begins in the deeper half is not the one that fills this place.
      sample.weight = sample.height > 0.3 * sample.room ? 1 : 0;
    }
  });
  rays_ = 3 * static_cast<long long>(samples_.size());
  for (std::size_t s = 0; s < samples_.size(); ++s) cells_[cell_of(samples_[s].position, kCell)].push_back(static_cast<int>(s));
}

void FleshField::collect(const Vec3& point, double radius, const std::vector<char>& concerns,
                         std::vector<const Sample*>& found) const {
  found.clear();
  const Vec3 low = point.array() - radius, high = point.array() + radius;
  for (double x = std::floor(low.x() / kCell); x * kCell <= high.x(); ++x) {
    for (double y = std::floor(low.y() / kCell); y * kCell <= high.y(); ++y) {
      for (double z = std::floor(low.z() / kCell); z * kCell <= high.z(); ++z) {
        const auto cell = cells_.find(cell_of(Vec3(x + 0.5, y + 0.5, z + 0.5) * kCell, kCell));
        if (cell == cells_.end()) continue;
        for (const int s : cell->second) {
          const Sample& sample = samples_[static_cast<std::size_t>(s)];
          const bool concerned = sample.region < 0 || concerns[static_cast<std::size_t>(sample.region)];
          if (concerned && (sample.position - point).squaredNorm() < radius * radius) found.push_back(&sample);
        }
      }
    }
  }
}

FleshPull FleshField::at(const Vec3& point, int muscle) const {
  if (samples_.empty()) return {};
  std::vector<const Sample*> near;
  double radius = 0.05;
  while (radius < 0.17) {
    collect(point, radius, concerns_[static_cast<std::size_t>(muscle)], near);
    if (near.size() >= 24) break;
    radius += 0.03;
  }
  double nearest = 1e9;
  for (const Sample* s : near) nearest = std::min(nearest, (s->position - point).squaredNorm());
  Vec3 outwards = Vec3::Zero();
  double weights = 0, depth = 0, layer = 0, used = 0, bone = 0, gap = 0, height = 0;
  for (const Sample* s : near) {
    const Vec3 to_skin = s->position - point;
    const double w = std::exp(-(to_skin.squaredNorm() - nearest) / (2 * kReach * kReach));
    weights += w;
    outwards += w * s->normal;
    depth += w * to_skin.dot(s->normal);
    layer += w * s->layer;
    used += w * s->weight;
    bone += w * s->weight * s->bone;
    gap += w * s->weight * (s->room - s->height);
    height += w * s->weight * s->height;
  }
  FleshPull pull;
  if (weights <= 0 || used < 0.05 * weights || outwards.norm() < 1e-9) return pull;
  pull.outwards = outwards.normalized();
  pull.free = (depth - layer) / weights;
  const double top = std::clamp(gap / used, -kMostShift, kMostShift), tall = height / used;
  const double above = bone / used - depth / weights;  // of this point over the bone
  pull.shift = top * std::clamp(above / tall, 0.0, 1.0);
  pull.stretch = std::clamp(1 + top / tall, kLeastStretch, kMostStretch);
  return pull;
}

}  // namespace ecorche
