#include "skinning/settle/elastic_skin.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/simd.h"
#include "anatomy/geometry/vertex_normals.h"
#include "skinning/settle/skin_looseness.h"

namespace ecorche {

namespace {

constexpr int kMembraneRounds = 2, kContactRounds = 2, kFillSteps = 2;
constexpr float kPressed = 1e-3f;  // m; what contact has moved further does not swell
// how open skin that has met other skin counts as: it rises by less than half, and muscles give way
// for the rest
constexpr float kMet = 0.1f;
constexpr double kRadiusShare = 0.8;  // an ear is far from bone, but there is not much of it
// m: skin that joints would stretch to twice its length goes as over so much tissue
constexpr double kLoosened = 0.055;
constexpr int kTissueRounds = 8, kStrainRounds = 4;

// Goes half of the way to the neighbours' mean, so many times.
void smooth(const std::vector<std::vector<int>>& rings, int rounds, std::vector<double>& values) {
  std::vector<double> next = values;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      double sum = 0;
      for (int j : rings[i]) sum += values[j];
      if (!rings[i].empty()) next[i] = 0.5 * values[i] + 0.5 * sum / double(rings[i].size());
    }
    values.swap(next);
  }
}

std::vector<double> tissue_of(const TriMesh& skin, const SkinSurvey& survey) {
  std::vector<double> out(survey.depth.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = std::min(survey.depth[i], kRadiusShare * survey.radius[i]);
  smooth(vertex_neighbours(skin), kTissueRounds, out);
  return out;
}

// How deep the tissue is that would let skin go as freely: the tissue's own depth, or more where
// joints stretch it.
std::vector<double> looseness_of(const Skeleton& skeleton, const TriMesh& skin,
                                 std::span<const std::array<Influence, 4>> joint_weights,
                                 std::span<const double> tissue) {
  std::vector<double> out = find_joint_strain(skeleton, skin, joint_weights);
  smooth(vertex_neighbours(skin), kStrainRounds, out);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::max(tissue[i], kLoosened * out[i]);
  return out;
}

}  // namespace

std::shared_ptr<const ElasticSkin> make_elastic_skin(
    const Skeleton& skeleton, const TriMesh& skin, const SkinSurvey& survey,
    std::span<const std::array<Influence, 4>> joint_weights, std::span<const int> order,
    std::span<const int> triangles) {
  const std::vector<double> tissue = tissue_of(skin, survey);
  const std::size_t n = tissue.size();
  TriMesh sorted{Points(skin.V.rows(), 3), Triangles(skin.F.rows(), 3)};
  std::copy(triangles.begin(), triangles.end(), sorted.F.data());
  std::vector<double> thickness(n);
  std::vector<std::array<Influence, 4>> weights(n);
  std::vector<float> positions(4 * n, 1);
  for (std::size_t s = 0; s < n; ++s) {
    const std::size_t v = order.empty() ? s : std::size_t(order[s]);
    sorted.V.row(s) = skin.V.row(v);
    thickness[s] = tissue[v];
    weights[s] = joint_weights[v];
    for (std::size_t k = 0; k < 3; ++k) positions[4 * s + k] = float(skin.V(v, Eigen::Index(k)));
  }
  std::vector<Vec3> rest;
  for (Eigen::Index s = 0; s < sorted.V.rows(); ++s) rest.push_back(sorted.V.row(s));
  Membrane membrane = make_membrane(sorted, looseness_of(skeleton, sorted, weights, thickness));
  SkinContact contact = make_skin_contact(membrane, positions, triangles, thickness);
  ElasticSkin out{
      std::move(membrane), make_limb_volumes(skeleton, positions, triangles, weights, thickness),
      std::move(contact),  std::move(thickness),
      std::move(weights),  std::move(rest)};
  return std::make_shared<const ElasticSkin>(std::move(out));
}

void settle_skin(const ElasticSkin& skin, std::span<const int> triangles,
                 std::span<const Transform> X_WJ, std::span<float> positions, ElasticScratch& s) {
  relax_membrane(skin.membrane, positions, triangles, kMembraneRounds, s.membrane);
  for (std::size_t k = 0; k < positions.size(); k += 4)
    store4(&positions[k], load4(&positions[k]) + load4(&s.membrane.offsets[k]));
  s.normals.resize(positions.size());
  vertex_normals(positions, triangles, s.normals, s.half);
  find_hollows(skin.membrane, positions, s.normals, s.open, s.working);
  keep_volumes(skin.volumes, X_WJ, s.open, s.normals, positions);
}

void find_rising(const ElasticSkin& skin, std::span<const float> positions, ElasticScratch& s) {
  s.rising = s.open;
  if (!find_meetings(skin.contact.patches, {skin.contact.give, 0, positions, s.normals},
                     s.contact.patches, s.contact.wanted))
    return;
  for (std::size_t i = 0; i < s.rising.size(); ++i)
    s.rising[i] *= s.contact.wanted[i] ? kMet : 1.0f;
}

bool part_settled_skin(const ElasticSkin& skin, std::span<const int> triangles,
                       std::span<const Transform> X_WJ, std::span<const float> room,
                       std::span<float> positions, ElasticScratch& s) {
  const std::size_t n = s.open.size();
  for (std::size_t i = 0; i < room.size(); ++i) s.open[i] *= room[i];
  s.pressed.assign(n, 0);
  const bool parted = part_skin(skin.membrane, skin.contact, triangles, kContactRounds, positions,
                                s.normals, s.contact),
             moved = parted || !room.empty();
  // What contact has pressed away swells where nothing presses.
  for (std::size_t i = 0; parted && i < n; ++i) {
    const Float4 way = load4(&positions[4 * i]) - load4(&s.contact.before[4 * i]);
    const float square = sum4(way * way)[0];
    if (!(square > 0)) continue;
    const float share = std::sqrt(square) / kPressed;
    s.pressed[i] = share > 1;
    s.open[i] *= std::max(0.0f, 1 - share);
  }
  for (int step = 0; step < (moved ? kFillSteps : 1); ++step)
    keep_volumes(skin.volumes, X_WJ, s.open, s.normals, positions,
                 room.empty() ? Hinges::kept : Hinges::free);
  return moved;
}

}  // namespace ecorche
