#include "skinning/settle/elastic_skin.h"

#include <algorithm>
#include <utility>

#include "anatomy/geometry/vertex_rings.h"
#include "skinning/settle/skin_looseness.h"

namespace ecorche::inline v1 {

namespace {

constexpr ElasticParameters kParameters;

// Moves values half of the way to their neighbours' mean, a round.
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

std::vector<double> tissue_of(const TriMesh& skin, const SkinProperties& properties) {
  std::vector<double> out(properties.depth.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = std::min(properties.depth[i], kParameters.radius_fraction * properties.radius[i]);
  smooth(vertex_neighbours(skin), kParameters.tissue_rounds, out);
  return out;
}

// Thickness of tissue that would let the skin move as freely: the tissue's own, or more where
// joints stretch it.
std::vector<double> looseness_of(const Skeleton& skeleton, const TriMesh& skin,
                                 std::span<const JointWeights> joint_weights,
                                 std::span<const double> tissue) {
  std::vector<double> out = find_joint_strain(skeleton, skin, joint_weights);
  smooth(vertex_neighbours(skin), kParameters.strain_rounds, out);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = std::max(tissue[i], kParameters.looseness_of_strain * out[i]);
  return out;
}

}  // namespace

ElasticSkin make_elastic_skin(const Skeleton& skeleton, const TriMesh& skin,
                              const SkinProperties& properties, std::span<const int> order,
                              std::span<const int> triangles) {
  const std::vector<double> tissue = tissue_of(skin, properties);
  const std::size_t n = tissue.size();
  TriMesh sorted{Points(skin.V.rows(), 3), Triangles(skin.F.rows(), 3)};
  std::copy(triangles.begin(), triangles.end(), sorted.F.data());
  ElasticSkin out;
  out.triangles.assign(triangles.begin(), triangles.end());
  out.tissue.resize(n);
  out.joint_weights.resize(n);
  std::vector<float> positions(4 * n, 1);
  for (std::size_t s = 0; s < n; ++s) {
    const std::size_t v = order.empty() ? s : std::size_t(order[s]);
    sorted.V.row(s) = skin.V.row(v);
    out.tissue[s] = tissue[v];
    out.joint_weights[s] = properties.joint_weights[v];
    for (std::size_t k = 0; k < 3; ++k) positions[4 * s + k] = float(skin.V(v, Eigen::Index(k)));
  }
  for (Eigen::Index s = 0; s < sorted.V.rows(); ++s) out.rest.push_back(sorted.V.row(s));
  out.membrane =
      make_membrane(sorted, looseness_of(skeleton, sorted, out.joint_weights, out.tissue));
  out.contact = make_self_contact(out.membrane, positions, triangles, out.tissue);
  out.folds = make_fold_planes(skeleton, out.rest, out.joint_weights, out.tissue);
  out.volumes = make_volume_regions(skeleton, positions, triangles, out.joint_weights, out.tissue);
  return out;
}

}  // namespace ecorche::inline v1
