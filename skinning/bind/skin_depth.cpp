#include "skinning/bind/skin_depth.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/vertex_rings.h"
#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kInset = 1e-3;  // m, below the skin: where lines of sight start
// m, a bone this close belongs to the vertex even if it pokes through the skin
constexpr double kAlwaysInReach = 6e-3;
constexpr double kMinRadius = 3e-3, kMaxRadius = 0.15;

std::vector<Vec3> rest_normals(const TriMesh& skin) {
  std::vector<Vec3> normals(skin.V.rows(), Vec3::Zero());
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    const Vec3 a = skin.V.row(skin.F(f, 0)), b = skin.V.row(skin.F(f, 1)),
               c = skin.V.row(skin.F(f, 2));
    const Vec3 area = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) normals[skin.F(f, k)] += area;
  }
  for (Vec3& n : normals) n = n.norm() > 0 ? Vec3(n.normalized()) : Vec3::UnitY();
  return normals;
}

// Averages with the neighbours, so that a ray through a fold or between fingers does not stand
// alone.
void smooth_skin_depth(const std::vector<std::vector<int>>& neighbours, int rounds,
                       std::vector<double>& values) {
  std::vector<double> next(values.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      double sum = values[i];
      for (int k : neighbours[i]) sum += values[k];
      next[i] = sum / (1.0 + double(neighbours[i].size()));
    }
    values.swap(next);
  }
}

// What lies nearest to a vertex.
struct Nearest {
  Anchor bone, muscle;  // the latter of kind none without muscles
  const Anchor& component() const {
    return muscle.kind != Anchor::Kind::none && muscle.distance < bone.distance ? muscle : bone;
  }
};

// Calls visit(vertex, Nearest) for every vertex of the skin, in parallel. Neighbours in memory are
// mostly neighbours in space, so the answer for one is a good guess at the next.
template <typename Visit>
void for_each_nearest(const AnatomySurfaces& surfaces, const TriMesh& skin, Visit visit) {
  constexpr std::size_t kBlock = 256;
  const std::size_t n = skin.V.rows();
  tbb::parallel_for(std::size_t{0}, (n + kBlock - 1) / kBlock, [&](std::size_t block) {
    SurfacePoint bone, muscle;
    for (std::size_t i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) {
      const Vec3 p = skin.V.row(i);
      Nearest nearest;
      bone = surfaces.bone_surface->nearest(p, bone.triangle);
      nearest.bone = {Anchor::Kind::bone, surfaces.bones.part[bone.triangle], bone.distance,
                      bone.point};
      if (surfaces.muscle_surface) {
        muscle = surfaces.muscle_surface->nearest(p, muscle.triangle);
        nearest.muscle = {Anchor::Kind::muscle, surfaces.muscles.part[muscle.triangle],
                          muscle.distance, muscle.point};
      }
      visit(i, nearest);
    }
  });
}

}  // namespace

PartMesh bone_mesh(const Anatomy& anatomy) {
  PartMesh out;
  std::vector<const TriMesh*> bones;
  for (std::size_t b = 0; b < anatomy.bones.size(); ++b) {
    const TriMesh& mesh = anatomy.bones[b].mesh;
    bones.push_back(&mesh);
    out.part.insert(out.part.end(), std::size_t(mesh.F.rows()), int(b));
  }
  out.mesh = join_meshes(bones);
  return out;
}

PartMesh muscle_mesh(const Anatomy& anatomy, const PosedAnatomy& rest, int sides) {
  const std::vector<SliceRange> ranges = slice_ranges(anatomy);
  Eigen::Index bands = 0;
  for (const SliceRange& range : ranges) bands += std::max(0, range.end - range.begin - 1);
  PartMesh out;
  out.mesh.V.resize(Eigen::Index(rest.slices.size()) * sides, 3);
  out.mesh.F.resize(2 * bands * sides, 3);
  for (std::size_t s = 0; s < rest.slices.size(); ++s) {
    const Ellipse& e = rest.slices[s];
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      out.mesh.V.row(Eigen::Index(s) * sides + k) =
          e.center + e.axes.col(0) * (e.radii.x() * std::cos(angle)) +
          e.axes.col(1) * (e.radii.y() * std::sin(angle));
    }
  }
  Eigen::Index f = 0;
  for (const SliceRange& range : ranges)
    // what lies in the skin's fat follows the skin, which follows what lies beneath
    for (int s = range.begin; s + 1 < range.end && !lies_in_fat(anatomy.muscles[range.muscle]); ++s)
      for (int k = 0; k < sides; ++k) {
        const int a = s * sides + k, b = s * sides + (k + 1) % sides;
        out.mesh.F.row(f++) << a, b, b + sides;
        out.mesh.F.row(f++) << a, b + sides, a + sides;
        out.part.insert(out.part.end(), 2, s);
      }
  out.mesh.F.conservativeResize(f, 3);
  return out;
}

AnatomySurfaces::AnatomySurfaces(const Anatomy& anatomy, const PosedAnatomy& rest)
    : bones(bone_mesh(anatomy)), muscles(muscle_mesh(anatomy, rest)) {
  for (const Bone& bone : anatomy.bones) bone_joint.push_back(bone.joint);
  const auto surface = [](const TriMesh& mesh) { return std::make_unique<NearestSurface>(mesh); };
  tbb::parallel_invoke([&] { bone_surface = surface(bones.mesh); },
                       [&] {
                         if (muscles.mesh.F.rows() > 0) muscle_surface = surface(muscles.mesh);
                       });
}

SkinDepth measure_skin_depth(const AnatomySurfaces& surfaces, const TriMesh& skin) {
  const std::size_t n = skin.V.rows();
  SkinDepth out;
  out.anchors.resize(n);
  out.muscles.resize(n);
  out.joint.assign(n, -1);
  out.depth.assign(n, 0);
  out.radius.assign(n, 0);
  out.normal = rest_normals(skin);
  const NearestSurface skin_surface(skin);
  for_each_nearest(surfaces, skin, [&](std::size_t i, const Nearest& nearest) {
    const Vec3 inside = Vec3(skin.V.row(i)) - kInset * out.normal[i];
    out.anchors[i] = nearest.component();
    out.muscles[i] = nearest.muscle;
    out.depth[i] = nearest.bone.distance;
    if (nearest.bone.distance < kAlwaysInReach || !skin_surface.blocked(inside, nearest.bone.point))
      out.joint[i] = surfaces.bone_joint[nearest.bone.part];
    const std::optional<double> through = skin_surface.cast(inside, -out.normal[i]);
    out.radius[i] = std::clamp(0.5 * through.value_or(2 * kMaxRadius), kMinRadius, kMaxRadius);
  });
  const std::vector<std::vector<int>> neighbours = vertex_neighbours(skin);
  smooth_skin_depth(neighbours, 12, out.radius);
  smooth_skin_depth(neighbours, 4, out.depth);
  return out;
}

std::vector<Anchor> find_anchors(const AnatomySurfaces& surfaces, const TriMesh& skin) {
  std::vector<Anchor> anchors(skin.V.rows());
  for_each_nearest(surfaces, skin, [&](std::size_t i, const Nearest& nearest) {
    anchors[i] = nearest.component();
  });
  return anchors;
}

}  // namespace ecorche::inline v1
