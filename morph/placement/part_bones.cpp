#include "morph/placement/part_bones.h"

#include <algorithm>
#include <memory>

#include <tbb/parallel_for.h>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/geometry/vertex_rings.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/placement/bone_groups.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kPartings = 6;
constexpr double kGap = 0.4e-3;     // m between parted surfaces
constexpr double kDeepest = 15e-3;  // m: deeper points are not looked for
constexpr double kOfThickness =
    0.3;                            // of the bone, along a vertex's normal: how far it goes in all
constexpr double kLeast = 0.05e-3;  // m: pairs that share less rest
constexpr int kRings = 12;          // over which a move fades
constexpr double kFade = 0.9;       // of a move, from one ring to the next

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

// Vertices inside `other` go half of the way out, into their own bone: where surfaces that face
// each other have crossed, the nearest way out of a thin bone may be through its far side.
void push_out(const Points& V, const Points& normals, const SkinRays& own, const SkinRays& other,
              const Box& box, Move& move) {
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const Vec3 x = V.row(i), inwards = -normals.row(i).transpose();
    if ((x.array() < box.low.array()).any() || (x.array() > box.high.array()).any()) continue;
    if (inwards.squaredNorm() < 0.5) continue;
    const RayHit hit = other.first_hit(x, inwards, kDeepest);
    if (hit.triangle < 0 || hit.facing <= 0 || hit.distance <= kLeast) continue;
    double& left = move.left[i];
    if (left < 0) {
      const RayHit through = own.first_hit(x, inwards, 1, kLeast);
      left = through.triangle >= 0 ? kOfThickness * double(through.distance) : 0;
    }
    const double by = std::min(0.5 * (double(hit.distance) + kGap), left);
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

}  // namespace

void part_bones(std::vector<Bone>& bones, std::optional<double> even_about) {
  const std::size_t count = bones.size();
  std::vector<std::vector<std::size_t>> near(count);  // that a bone may lie in
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b < count; ++b)
      if (a != b && !share_teeth(bones[a], bones[b]) &&
          meet(box_of(bones[a].mesh.V), box_of(bones[b].mesh.V)))
        near[a].push_back(b);
  std::vector<std::vector<std::vector<int>>> rings(count);
  std::vector<Move> moves(count);
  for (int round = 0; round < kPartings; ++round) {
    std::vector<std::unique_ptr<SkinRays>> rays(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t b) {
      const bool asked = std::ranges::any_of(
          near, [&](const auto& of) { return std::ranges::find(of, b) != of.end(); });
      if (asked && mesh_volume(bones[b].mesh) > 0)
        rays[b] = std::make_unique<SkinRays>(bones[b].mesh, RayBuild::quick);
    });
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t a) {
      const Points& V = bones[a].mesh.V;
      Move& move = moves[a];
      move.by = Points::Zero(V.rows(), 3);
      move.pushed.assign(std::size_t(V.rows()), false);
      move.most = 0;
      if (move.left.size() == 0) move.left = Eigen::VectorXd::Constant(V.rows(), -1);
      if (near[a].empty() || !rays[a]) return;
      const Points normals = vertex_normals(bones[a].mesh);
      std::erase_if(near[a], [&](std::size_t b) {
        if (!rays[b]) return true;
        const double before = move.most;
        const auto pushed = std::ranges::count(move.pushed, true);
        push_out(V, normals, *rays[a], *rays[b], box_of(bones[b].mesh.V), move);
        return move.most == before && std::ranges::count(move.pushed, true) == pushed;
      });
      if (move.most <= 0) return;
      if (rings[a].empty()) rings[a] = vertex_neighbours(bones[a].mesh);
      follow(rings[a], normals, move);
      for (Eigen::Index i = 0; i < V.rows(); ++i)
        if (move.left[i] > 0) move.left[i] = std::max(0.0, move.left[i] - move.by.row(i).norm());
    });
    bool moved = false;
    for (std::size_t a = 0; a < count; ++a) {
      if (moves[a].most <= 0) continue;
      bones[a].mesh.V += moves[a].by;
      moved = true;
    }
    if (even_about)
      for (Bone& right : bones) {
        if (right.side != Side::right) continue;
        const auto left = std::ranges::find_if(bones, [&](const Bone& bone) {
          return bone.side == Side::left &&
                 split_side(bone.name).first == split_side(right.name).first;
        });
        if (left == bones.end() || left->mesh.V.rows() != right.mesh.V.rows()) continue;
        right.mesh.V = left->mesh.V;
        right.mesh.V.col(0) = 2 * *even_about - right.mesh.V.col(0).array();
      }
    if (!moved) break;
  }
}

}  // namespace ecorche::inline v1
