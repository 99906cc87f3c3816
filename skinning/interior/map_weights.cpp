#include "skinning/interior/map_weights.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kSpacing = 0.012;  // m, of the lattice
constexpr int kCoarseRounds = 60, kFineRounds = 20;
constexpr double kForeign = 0.3;  // weight of joints that a muscle's line does not pass
// Of a joint and of a control of the skin, else they are left out.
constexpr double kLeastWeight = 0.002, kLeastSkinWeight = 0.01;

SourceWeights one_source(int source) {
  SourceWeights out;
  out.source[0] = short(source);
  out.weight[0] = 1;
  out.count = 1;
  return out;
}

// The joint whose bones have most vertices in a node's cell holds the node.
std::vector<SourceWeights> bone_nodes(const BodyLattice& lattice, const Anatomy& anatomy) {
  std::vector<std::map<int, int>> vertices(lattice.nodes());
  for (const Bone& bone : anatomy.bones)
    for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v) {
      const int node = lattice.node(lattice.cell(bone.mesh.V.row(v)));
      if (node >= 0) ++vertices[node][bone.joint];
    }
  std::vector<SourceWeights> out(lattice.nodes());
  for (int i = 0; i < lattice.nodes(); ++i) {
    int most = 0;
    for (const auto& [joint, count] : vertices[i])
      if (count > most) {
        most = count;
        out[i] = one_source(joint);
      }
  }
  return out;
}

// Nodes beside the skin have the weights of the nearest vertex, bones are one source more.
std::vector<SourceWeights> skin_nodes(const BodyLattice& lattice, const TriMesh& skin,
                                      const SkinControls& controls,
                                      std::span<const SourceWeights> bones) {
  const NearestSurface surface(skin);
  std::vector<SourceWeights> out(lattice.nodes());
  tbb::parallel_for(0, lattice.nodes(), [&](int i) {
    if (bones[i].count > 0) {
      out[i] = one_source(int(controls.vertices.size()));
      return;
    }
    if (std::ranges::all_of(lattice.links[i], [](int other) { return other >= 0; })) return;
    const SurfacePoint p = surface.nearest(lattice.points[i]);
    const auto distance = [&](int v) {
      return (skin.V.row(v).transpose() - p.point).squaredNorm();
    };
    int nearest = skin.F(p.triangle, 0);
    for (int k = 1; k < 3; ++k)
      if (distance(skin.F(p.triangle, k)) < distance(nearest)) nearest = skin.F(p.triangle, k);
    out[i] = controls.weights[nearest];
  });
  return out;
}

// Weights in the fine lattice, from those in the coarse one on.
std::vector<SourceWeights> solve(const MapWeights& lattices, const SkinRays& skin,
                                 std::span<const SourceWeights> on_coarse,
                                 std::span<const SourceWeights> on_fine, int sources) {
  const BodyLattice &coarse = lattices.coarse, &fine = lattices.fine;
  const auto first = harmonic_weights(coarse, on_coarse, sources, {}, kCoarseRounds);
  std::vector<SourceWeights> start(fine.nodes());
  tbb::parallel_for(0, fine.nodes(), [&](int i) {
    start[i] = mix_weights(lattice_shares(coarse, skin, fine.points[i]), first);
  });
  return harmonic_weights(fine, on_fine, sources, start, kFineRounds);
}

// Weights of more than `least`. Sources that are not `own` (empty: all are) count less.
SourceWeights kept_weights(const SourceWeights& all, double least,
                           std::span<const double> own = {}) {
  std::vector<std::pair<int, double>> weights;
  for (int k = 0; k < all.count; ++k) {
    const int source = all.source[k];
    const double share = own.empty() ? 1 : kForeign + (1 - kForeign) * own[source];
    const double weight = share * double(all.weight[k]);
    if (weight > least) weights.emplace_back(source, weight);
  }
  return largest_weights(weights);
}

// Weights of which a share is others'.
SourceWeights mixed(const SourceWeights& all, const SourceWeights& others, double share) {
  if (share <= 0) return all;
  std::vector<std::pair<int, double>> weights;
  for (const auto& [from, times] : {std::pair(&all, 1 - share), std::pair(&others, share)})
    for (int k = 0; k < from->count; ++k)
      weights.emplace_back(from->source[k], times * double(from->weight[k]));
  return largest_weights(weights);
}

// Of the nearest node that any bone reaches: a slit, as between the lips, parts some from all.
SourceWeights nearest_joints(const MapWeights& weights, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  int nearest = -1;
  for (int i = 0; i < weights.fine.nodes(); ++i) {
    const double squared = (weights.fine.points[i] - p).squaredNorm();
    if (weights.joints[i].count > 0 && squared < least) least = squared, nearest = i;
  }
  return nearest < 0 ? one_source(0) : weights.joints[nearest];
}

}  // namespace

MapWeights make_map_weights(const Anatomy& anatomy, const SkinRays& skin,
                            const SkinControls& controls) {
  MapWeights out;
  out.coarse = make_body_lattice(skin, 2 * kSpacing);
  out.fine = make_body_lattice(skin, kSpacing);
  out.skin_bone = int(controls.vertices.size());
  const auto coarse_bones = bone_nodes(out.coarse, anatomy),
             fine_bones = bone_nodes(out.fine, anatomy);
  if (std::ranges::none_of(fine_bones, [](const SourceWeights& node) { return node.count > 0; }))
    throw UnfitError("map of the body's inside: no bone lies within the skin");
  for (const SourceWeights& node : coarse_bones) out.bone.push_back(node.count > 0);
  out.joints = solve(out, skin, coarse_bones, fine_bones, int(anatomy.skeleton.joints.size()));
  out.skin = solve(out, skin, skin_nodes(out.coarse, skin.mesh(), controls, coarse_bones),
                   skin_nodes(out.fine, skin.mesh(), controls, fine_bones), out.skin_bone + 1);
  return out;
}

MapPoint place_point(const MapWeights& weights, const SkinRays& skin, const Vec3& point,
                     std::span<const double> own, const BoneHold& hold, const GlideHold& glide) {
  const auto shares = lattice_shares(weights.fine, skin, point);
  MapPoint out;
  out.rest = point;
  SourceWeights joints = mix_weights(shares, weights.joints);
  if (joints.count == 0) joints = nearest_joints(weights, point);
  joints = mixed(kept_weights(joints, kLeastWeight, own), glide.joints, glide.share);
  out.joints = mixed(joints, one_source(hold.joint), hold.share);
  out.skin = mixed(kept_weights(mix_weights(shares, weights.skin), kLeastSkinWeight),
                   one_source(weights.skin_bone), hold.share);
  out.cells = lattice_shares(weights.coarse, skin, point);
  for (LatticeShare& share : out.cells) share.weight *= 1 - hold.share;
  return out;
}

}  // namespace ecorche::inline v1
