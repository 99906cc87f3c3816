#include "morph/placement/part_bones.h"

#include <algorithm>
#include <memory>

#include <tbb/parallel_for.h>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/mirror_mesh.h"
#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/geometry/vertex_rings.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/placement/bone_groups.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kPartings = 6;
constexpr double kGap = 0.1e-3;     // m between parted surfaces
constexpr double kDeepest = 15e-3;  // m: deeper points are not looked for
constexpr double kOfThickness =
    0.15;                           // of the bone, along a vertex's normal: how far it goes in all
constexpr double kLeast = 0.05e-3;  // m: pairs that share less rest
constexpr int kRings = 12;          // over which a move fades
constexpr double kFade = 0.8;       // of a move, from one ring to the next

struct Box {
  Vec3 low, high;
};

Box box_of(const Points& V) { return {V.colwise().minCoeff(), V.colwise().maxCoeff()}; }

bool meet(const Box& a, const Box& b) {
  return (a.low.array() < b.high.array()).all() && (b.low.array() < a.high.array()).all();
}

// Teeth of the one close between those of the other.
bool share_teeth(const Bone& a, const Bone& b) {
  return (a.name == "skull" && b.name == "mandible") || (a.name == "mandible" && b.name == "skull");
}

// Where the vertices of one bone have to go; and which it is that they have to.
struct Move {
  Points by;
  Eigen::VectorXd left;  // m that vertices may still go; negative: not known yet
  std::vector<bool> pushed;
  double most = 0;  // m
};

// A bone with what rays are cast by.
struct Probe {
  std::unique_ptr<SkinRays> rays;
  Points normals;
};

// m by which vertex i of a bone lies in another, straight into its own bone; 0 outside. Where
// surfaces that face each other have crossed, the nearest way out of a thin bone may be through its
// far side.
double depth_in(const Points& V, const Points& normals, Eigen::Index i, const SkinRays& other) {
  const Vec3 inwards = -normals.row(i).transpose();
  if (inwards.squaredNorm() < 0.5) return 0;
  const RayHit hit = other.first_hit(V.row(i), inwards, kDeepest);
  return hit.triangle >= 0 && hit.facing > 0 ? double(hit.distance) : 0;
}

// Vertices inside `other` go half of the way out. `shared`: what vertex i has in it anyway.
template <typename Shared>
void push_out(const Points& V, const Probe& own, const SkinRays& other, const Box& box,
              const Shared& shared, Move& move) {
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const Vec3 x = V.row(i);
    if ((x.array() < box.low.array()).any() || (x.array() > box.high.array()).any()) continue;
    const double depth = depth_in(V, own.normals, i, other);
    if (depth <= kLeast) continue;
    const double more = depth - shared(i);
    if (more <= kLeast) continue;
    const Vec3 inwards = -own.normals.row(i).transpose();
    double& left = move.left[i];
    if (left < 0) {
      const RayHit through = own.rays->first_hit(x, inwards, 1, kLeast);
      left = through.triangle >= 0 ? kOfThickness * double(through.distance) : 0;
    }
    const double by = std::min(0.5 * (more + kGap), left);
    if (by <= move.by.row(i).norm()) continue;
    move.by.row(i) = by * inwards.transpose();
    move.pushed[std::size_t(i)] = true;
    move.most = std::max(move.most, by);
  }
}

// Vertices about those that are pushed follow, but not out of their bone.
void follow(const std::vector<std::vector<int>>& rings, const Points& normals, Move& move) {
  for (int k = 0; k < kRings; ++k) {
    const Points before = move.by;
    for (std::size_t i = 0; i < rings.size(); ++i) {
      if (move.pushed[i] || rings[i].empty()) continue;
      Vec3 sum = Vec3::Zero();
      for (const int j : rings[i]) sum += before.row(j);
      const Vec3 by = (kFade / double(rings[i].size())) * sum, out = normals.row(Eigen::Index(i));
      move.by.row(Eigen::Index(i)) = by - std::max(0.0, by.dot(out)) * out;
    }
  }
}

// What rays are cast by, of bones that others may lie in or that may lie in others.
std::vector<Probe> probes_of(const std::vector<const Bone*>& bones,
                             const std::vector<std::vector<std::size_t>>& near) {
  std::vector<bool> asked(bones.size(), false);
  for (std::size_t a = 0; a < near.size(); ++a)
    for (const std::size_t b : near[a]) asked[a] = asked[b] = true;
  std::vector<Probe> out(bones.size());
  tbb::parallel_for(std::size_t{0}, bones.size(), [&](std::size_t b) {
    if (!asked[b] || !bones[b] || mesh_volume(bones[b]->mesh) <= 0) return;
    out[b] = {std::make_unique<SkinRays>(bones[b]->mesh, RayBuild::quick),
              vertex_normals(bones[b]->mesh)};
  });
  return out;
}

// The reference's bones of the same names and vertices; null where there is none.
std::vector<const Bone*> same_bones(const std::vector<Bone>& bones,
                                    const std::vector<Bone>& reference) {
  std::vector<const Bone*> out;
  for (const Bone& bone : bones) {
    const auto same = std::ranges::find(reference, bone.name, &Bone::name);
    const bool found = same != reference.end() && same->mesh.V.rows() == bone.mesh.V.rows();
    out.push_back(found ? &*same : nullptr);
  }
  return out;
}

void mirror_right(double plane, std::vector<Bone>& bones) {
  for (Bone& right : bones) {
    if (right.side != Side::right) continue;
    const auto left = std::ranges::find_if(bones, [&](const Bone& bone) {
      return bone.side == Side::left && split_side(bone.name).first == split_side(right.name).first;
    });
    if (left == bones.end() || left->mesh.V.rows() != right.mesh.V.rows()) continue;
    right.mesh.V = mirror_mesh(left->mesh, plane).V;
  }
}

}  // namespace

void part_bones(std::vector<Bone>& bones, const std::vector<Bone>& reference,
                std::optional<double> even_about) {
  const std::size_t count = bones.size();
  std::vector<std::vector<std::size_t>> near(count);  // that a bone may lie in
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b < count; ++b)
      if (a != b && !share_teeth(bones[a], bones[b]) &&
          meet(box_of(bones[a].mesh.V), box_of(bones[b].mesh.V)))
        near[a].push_back(b);
  const std::vector<const Bone*> before = same_bones(bones, reference);
  const std::vector<Probe> probes_before = probes_of(before, near);
  std::vector<std::vector<std::vector<int>>> rings(count);
  std::vector<Move> moves(count);
  for (int round = 0; round < kPartings; ++round) {
    std::vector<const Bone*> now;
    for (const Bone& bone : bones) now.push_back(&bone);
    const std::vector<Probe> probes = probes_of(now, near);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t a) {
      const Points& V = bones[a].mesh.V;
      Move& move = moves[a];
      move.by = Points::Zero(V.rows(), 3);
      move.pushed.assign(std::size_t(V.rows()), false);
      move.most = 0;
      if (move.left.size() == 0) move.left = Eigen::VectorXd::Constant(V.rows(), -1);
      if (near[a].empty() || !probes[a].rays) return;
      std::erase_if(near[a], [&](std::size_t b) {
        if (!probes[b].rays) return true;
        const bool known = before[a] && probes_before[a].rays && probes_before[b].rays;
        const auto shared = [&](Eigen::Index i) {
          return known ? depth_in(before[a]->mesh.V, probes_before[a].normals, i,
                                  *probes_before[b].rays)
                       : 0.0;
        };
        const double most = move.most;
        const auto pushed = std::ranges::count(move.pushed, true);
        push_out(V, probes[a], *probes[b].rays, box_of(bones[b].mesh.V), shared, move);
        return move.most == most && std::ranges::count(move.pushed, true) == pushed;
      });
      if (move.most <= 0) return;
      if (rings[a].empty()) rings[a] = vertex_neighbours(bones[a].mesh);
      follow(rings[a], probes[a].normals, move);
      for (Eigen::Index i = 0; i < V.rows(); ++i)
        if (move.left[i] > 0) move.left[i] = std::max(0.0, move.left[i] - move.by.row(i).norm());
    });
    bool moved = false;
    for (std::size_t a = 0; a < count; ++a) {
      if (moves[a].most <= 0) continue;
      bones[a].mesh.V += moves[a].by;
      moved = true;
    }
    if (!moved) break;
    if (even_about) mirror_right(*even_about, bones);
  }
}

}  // namespace ecorche::inline v1
