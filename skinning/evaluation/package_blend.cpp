#include "skinning/evaluation/package_blend.h"
#include "anatomy/base_mesh/body_rig.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace ecorche::inline v1 {
namespace {

// Similarity of the neighbourhood of `p` from one shape to another, applied to p (Umeyama
// 1991, 10.1109/34.88573).
Vec3 carried_by_skin(const Vec3& p, const Points& from, const Points& to) {
  constexpr int kNeighbours = 80;
  std::vector<int> order(to.rows());
  std::iota(order.begin(), order.end(), 0);
  const auto nearer = [&](int l, int r) {
    return (from.row(l).transpose() - p).squaredNorm() <
           (from.row(r).transpose() - p).squaredNorm();
  };
  std::nth_element(order.begin(), order.begin() + kNeighbours, order.end(), nearer);
  Eigen::MatrixXd a(3, kNeighbours), b(3, kNeighbours);
  for (int i = 0; i < kNeighbours; ++i) {
    a.col(i) = from.row(order[i]).transpose();
    b.col(i) = to.row(order[i]).transpose();
  }
  const Eigen::Matrix4d X = Eigen::umeyama(a, b, true);
  return (X * p.homogeneous()).head<3>();
}

}  // namespace

LinearBaseline make_linear_baseline(const BodyPackage& package, const Skeleton& skeleton,
                                    const TriMesh& skin) {
  LinearBaseline baseline;
  baseline.rig = read_rig(package, "default", package.points);
  for (auto* places : {&baseline.rig.heads, &baseline.rig.tails})
    for (Vec3& place : *places) place = carried_by_skin(place, package.points, skin.V);
  baseline.links = link_default_rig(baseline.rig, skeleton);
  const VertexWeights& shares = baseline.rig.weights;
  std::vector<std::vector<BoneWeight>> weights(skin.V.rows());
  for (Eigen::Index i = 0; i < skin.V.rows(); ++i)
    for (int k = shares.start[i]; k < shares.start[i + 1]; ++k)
      weights[i].push_back({shares.bone[k], shares.weight[k]});
  baseline.skin = make_blend_skin(skin, weights);
  return baseline;
}

void deform_linear_baseline(const LinearBaseline& baseline, const Skeleton& skeleton,
                            std::span<const Transform> X_WJ, SkinFrame& out) {
  std::vector<Transform> bones;
  pose_rig(baseline.rig, baseline.links, skeleton, X_WJ, bones);
  deform_linear(baseline.skin, bones, out);
}

}  // namespace ecorche::inline v1
