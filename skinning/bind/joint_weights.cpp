#include "skinning/bind/joint_weights.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>

#include "anatomy/errors.h"
#include "anatomy/geometry/vertex_rings.h"

namespace ecorche::inline v1 {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kLeastCotan = 0.02;  // negative cotangents would make weights overshoot

double cotan(const Vec3& a, const Vec3& b) { return a.dot(b) / std::max(a.cross(b).norm(), 1e-12); }

// Cotan Laplacian (positive semi-definite) plus the screening diagonal.
Sparse screened_laplacian(const TriMesh& skin, const Eigen::VectorXd& screen) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(12 * skin.F.rows() + skin.V.rows());
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int i = skin.F(f, (k + 1) % 3), j = skin.F(f, (k + 2) % 3);
      const Vec3 o = skin.V.row(skin.F(f, k));
      const Vec3 a = skin.V.row(i).transpose() - o, b = skin.V.row(j).transpose() - o;
      const double w = std::max(0.5 * cotan(a, b), kLeastCotan);
      entries.emplace_back(i, i, w);
      entries.emplace_back(j, j, w);
      entries.emplace_back(i, j, -w);
      entries.emplace_back(j, i, -w);
    }
  for (Eigen::Index i = 0; i < screen.size(); ++i) entries.emplace_back(i, i, screen[i]);
  Sparse A(skin.V.rows(), skin.V.rows());
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

Eigen::VectorXd vertex_areas(const TriMesh& skin) {
  Eigen::VectorXd areas = Eigen::VectorXd::Constant(skin.V.rows(), 1e-12);
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    const Vec3 a = skin.V.row(skin.F(f, 0)), b = skin.V.row(skin.F(f, 1)),
               c = skin.V.row(skin.F(f, 2));
    const double third = (b - a).cross(c - a).norm() / 6;
    for (int k = 0; k < 3; ++k) areas[skin.F(f, k)] += third;
  }
  return areas;
}

constexpr int kLanes = 8;
using Lanes = Eigen::Array<double, kLanes, 1>;

// Spreads indicator functions of labels with the lengths given; see the header.
class Diffusion {
 public:
  Diffusion(const TriMesh& skin, const Eigen::VectorXd& length)
      : screen_(vertex_areas(skin).cwiseQuotient(length.cwiseAbs2())) {
    solver_.compute(screened_laplacian(skin, screen_));
  }

  // Up to kLanes labels at once: going through the factor is what costs, whether for one label or
  // for eight. #V
  std::vector<Lanes> spread(std::span<const std::vector<int>* const> labels) const {
    std::vector<Lanes> x(screen_.size(), Lanes::Zero());
    const auto& place = solver_.permutationP().indices();
    for (std::size_t lane = 0; lane < labels.size(); ++lane)
      for (int i : *labels[lane]) x[place[i]][lane] = screen_[i];
    solve(x);
    for (Eigen::Index i = 0; i < screen_.size(); ++i) x[place[i]] *= screen_[i];
    solve(x);
    std::vector<Lanes> out(x.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = x[place[i]];
    return out;
  }

 private:
  // In the factor's own order.
  void solve(std::vector<Lanes>& x) const {
    const auto factor = solver_.matrixL();
    const Sparse& L = factor.nestedExpression();
    const Eigen::VectorXd D = solver_.vectorD();
    for (Eigen::Index c = 0; c < L.cols(); ++c) {
      const Lanes& above = x[c];
      if ((above == 0).all()) continue;
      for (Sparse::InnerIterator it(L, c); it; ++it)
        if (it.row() > c) x[it.row()] -= it.value() * above;
    }
    for (Eigen::Index c = L.cols() - 1; c >= 0; --c) {
      Lanes sum = x[c] / D[c];
      for (Sparse::InnerIterator it(L, c); it; ++it)
        if (it.row() > c) sum -= it.value() * x[it.row()];
      x[c] = sum;
    }
  }

  Eigen::VectorXd screen_;
  Eigen::SimplicialLDLT<Sparse> solver_;
};

// Vertices that reach no bone take the label of the nearest one along the edges that does.
std::vector<int> complete_labels(const TriMesh& skin, const std::vector<int>& labels) {
  const std::vector<std::vector<int>> neighbours = vertex_neighbours(skin);
  std::vector<int> out = labels, front;
  for (std::size_t i = 0; i < out.size(); ++i)
    if (out[i] >= 0) front.push_back(int(i));
  for (std::size_t k = 0; k < front.size(); ++k)
    for (int v : neighbours[front[k]])
      if (out[v] < 0) {
        out[v] = out[front[k]];
        front.push_back(v);
      }
  return out;
}

// Group 0 is the trunk with the head; 1 .. 4 the limbs.
std::vector<int> limb_groups(const Skeleton& skeleton) {
  std::vector<int> group(skeleton.joints.size(), 0);
  const char* roots[] = {"shoulder_l", "shoulder_r", "hip_l", "hip_r"};
  for (std::size_t j = 0; j < group.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent >= 0) group[j] = group[parent];
    for (int g = 0; g < 4; ++g)
      if (skeleton.joints[j].name == roots[g]) group[j] = g + 1;
  }
  return group;
}

// Longest length with which limbs are told from the trunk: 30 mm at the shoulders and 50 mm at the
// hips of a trunk of 0.5 m.
Eigen::VectorXd limb_length_limit(const Skeleton& skeleton, const TriMesh& skin) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  const int shoulder = find_joint(skeleton, "shoulder_l"), hip = find_joint(skeleton, "hip_l");
  if (shoulder < 0 || hip < 0) return Eigen::VectorXd::Constant(skin.V.rows(), 1.0);
  const double low = origins[hip].y(), trunk = origins[shoulder].y() - low;
  Eigen::VectorXd limit(skin.V.rows());
  for (Eigen::Index i = 0; i < limit.size(); ++i) {
    const double t = std::clamp((skin.V(i, 1) - low) / std::abs(trunk), 0.0, 1.0);
    limit[i] = std::abs(trunk) * (0.10 - 0.04 * t);
  }
  return limit;
}

}  // namespace

std::vector<WeightRow> diffuse_joint_weights(const Skeleton& skeleton, const TriMesh& skin,
                                             const SkinDepth& depth, double blend_width) {
  const std::size_t n = std::size_t(skin.V.rows()), joints = skeleton.joints.size();
  const std::vector<int> group = limb_groups(skeleton);
  std::vector<std::vector<int>> members(joints), limbs(5);
  const std::vector<int> labels = complete_labels(skin, depth.joint);
  Eigen::VectorXd length(skin.V.rows());
  for (std::size_t i = 0; i < n; ++i) {
    const int j = labels[i];
    // The inside of a bent limb stays unfolded while l > radius * angle / 4.
    length[i] = blend_width *
                (0.4 * depth.radius[i] + 0.25 * std::min(depth.depth[i], 2 * depth.radius[i]));
    if (j < 0) continue;
    members[j].push_back(int(i));
    limbs[group[j]].push_back(int(i));
  }
  std::vector<int> used;
  for (std::size_t j = 0; j < joints; ++j)
    if (!members[j].empty()) used.push_back(int(j));
  if (used.empty())
    throw UnfitError("skin: no vertex has a bone beneath it; is the anatomy inside this skin?");

  std::unique_ptr<Diffusion> wide, narrow;
  tbb::parallel_invoke([&] { wide = std::make_unique<Diffusion>(skin, length); },
                       [&] {
                         narrow = std::make_unique<Diffusion>(
                             skin,
                             length.cwiseMin(blend_width * limb_length_limit(skeleton, skin)));
                       });
  std::vector<const std::vector<int>*> wanted;
  for (int j : used) wanted.push_back(&members[j]);
  std::vector<std::vector<Lanes>> weights((used.size() + kLanes - 1) / kLanes);
  std::vector<Lanes> limb_weights;
  tbb::parallel_for(std::size_t{0}, weights.size() + 1, [&](std::size_t batch) {
    if (batch < weights.size()) {
      const std::size_t first = batch * kLanes;
      weights[batch] = wide->spread(
          std::span(wanted).subspan(first, std::min<std::size_t>(kLanes, wanted.size() - first)));
      return;
    }
    std::vector<const std::vector<int>*> groups;
    for (const std::vector<int>& limb : limbs) groups.push_back(&limb);
    limb_weights = narrow->spread(groups);
  });

  std::vector<WeightRow> rows(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto weight = [&](std::size_t u) {
      return std::max(0.0, weights[u / kLanes][i][u % kLanes]);
    };
    const auto group_of = [&](std::size_t u) { return group[used[u]]; };
    std::array<double, 5>
        within{};  // sum of a group's joints, so that they share what the group has
    for (std::size_t u = 0; u < used.size(); ++u) within[group_of(u)] += weight(u);
    double sum = 0;
    for (std::size_t u = 0; u < used.size(); ++u) {
      const double all = within[group_of(u)];
      const double w =
          std::max(0.0, limb_weights[i][group_of(u)]) * weight(u) / std::max(all, 1e-12);
      if (w < 1e-4) continue;
      rows[i].push_back({used[u], w});
      sum += w;
    }
    if (rows[i].empty())
      rows[i].push_back(
          {std::max(labels[i], 0), sum = 1});  // a piece of skin on its own, out of reach
    for (Influence& influence : rows[i]) influence.weight /= sum;
  }
  return rows;
}

}  // namespace ecorche::inline v1
