#include "morph/tissue/interior_warp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/SparseCholesky>

#include <fmt/format.h>

#include "anatomy/compute/linear_systems.h"
#include "anatomy/errors.h"
#include "morph/placement/half_skeleton.h"

namespace ecorche::inline v1 {
namespace {

using Vec4 = Eigen::Vector4d;

// Gradients of a tetrahedron's four linear functions (rows), and its volume.
struct Gradients {
  Eigen::Matrix<double, 4, 3> of;
  double volume = 0;
};
Gradients gradients(const Points& V, const Eigen::RowVector4i& t) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = (V.row(t[k + 1]) - V.row(t[0])).transpose();
  Gradients out;
  out.volume = edges.determinant() / 6;
  out.of.bottomRows<3>() = edges.inverse();
  out.of.row(0) = -out.of.bottomRows<3>().colwise().sum();
  return out;
}

// Finds the tetrahedron of a point by a grid of cells that list the tetrahedra whose boxes reach
// into them.
class TetrahedronGrid {
 public:
  explicit TetrahedronGrid(const TissueMesh& mesh) : V_(mesh.V), T_(mesh.T) {
    corner_ = V_.colwise().minCoeff();
    const Vec3 high = V_.colwise().maxCoeff();
    size_ = ((high - corner_).array() / kCell).floor().cast<int>() + 1;
    cells_.resize(size_.prod());
    for (Eigen::Index t = 0; t < T_.rows(); ++t) {
      Vec3 low = V_.row(T_(t, 0)), top = low;
      for (int k = 1; k < 4; ++k) {
        low = low.cwiseMin(V_.row(T_(t, k)).transpose());
        top = top.cwiseMax(V_.row(T_(t, k)).transpose());
      }
      const Eigen::Array3i a = cell(low), b = cell(top);
      for (int x = a[0]; x <= b[0]; ++x)
        for (int y = a[1]; y <= b[1]; ++y)
          for (int z = a[2]; z <= b[2]; ++z) cells_[index(x, y, z)].push_back(int(t));
    }
    for (Eigen::Index t = 0; t < T_.rows(); ++t) gradients_.push_back(gradients(V_, T_.row(t)).of);
  }

  // The tetrahedron that holds p, or of those near the one that it is least far out of; weights of
  // its corners, brought inside.
  int find(const Vec3& p, Vec4& weights) const {
    const Eigen::Array3i at = cell(p);
    for (int reach = 0; reach <= size_.maxCoeff(); ++reach) {
      int best = -1;
      double most = -std::numeric_limits<double>::infinity();
      for (int x = std::max(at[0] - reach, 0); x <= std::min(at[0] + reach, size_[0] - 1); ++x)
        for (int y = std::max(at[1] - reach, 0); y <= std::min(at[1] + reach, size_[1] - 1); ++y)
          for (int z = std::max(at[2] - reach, 0); z <= std::min(at[2] + reach, size_[2] - 1); ++z)
            for (const int t : cells_[index(x, y, z)]) {
              const Vec4 w = weights_in(t, p);
              if (w.minCoeff() <= most) continue;
              most = w.minCoeff();
              best = t;
              weights = w;
            }
      if (best < 0) continue;
      weights = weights.cwiseMax(0);
      weights /= weights.sum();
      return best;
    }
    return -1;
  }

 private:
  static constexpr double kCell = 0.02;  // m

  Eigen::Array3i cell(const Vec3& p) const {
    return ((p - corner_).array() / kCell)
        .floor()
        .max(-1e6)
        .min(1e6)
        .cast<int>()
        .max(0)
        .min(size_ - 1);
  }
  std::size_t index(int x, int y, int z) const {
    return (std::size_t(x) * size_[1] + y) * std::size_t(size_[2]) + z;
  }
  Vec4 weights_in(int t, const Vec3& p) const {
    Vec4 w = gradients_[t] * (p - V_.row(T_(t, 0)).transpose());
    w[0] += 1;
    return w;
  }

  const Points& V_;
  const Tetrahedra& T_;
  Vec3 corner_ = Vec3::Zero();
  Eigen::Array3i size_ = Eigen::Array3i::Zero();
  std::vector<std::vector<int>> cells_;
  std::vector<Eigen::Matrix<double, 4, 3>> gradients_;
};

Vec3 anchor_shift(const TissueAnchor& anchor, const BodyPair& pair) {
  const bool bone = anchor.kind == TissueAnchor::Kind::bone;
  const std::size_t b = std::max(anchor.bone, 0);
  if (bone && (b >= pair.bones_before->size() || b >= pair.bones_after->size()))
    throw std::invalid_argument("interior warp: a bone is missing");
  const Points& before = bone ? (*pair.bones_before)[b].mesh.V : *pair.skin_before;
  const Points& after = bone ? (*pair.bones_after)[b].mesh.V : *pair.skin_after;
  Vec3 shift = Vec3::Zero();
  for (std::size_t k = 0; k < (bone ? 1 : 3); ++k) {
    const int v = anchor.vertices[k];
    if (v < 0 || v >= before.rows() || v >= after.rows())
      throw std::invalid_argument("interior warp: skin or bone with other vertices");
    shift += (bone ? 1 : anchor.weights[k]) * (after.row(v) - before.row(v)).transpose();
  }
  return shift;
}

}  // namespace

struct HarmonicSolver::Data {
  explicit Data(TissueMesh m) : mesh(std::move(m)), grid(mesh) {}
  TissueMesh mesh;
  TetrahedronGrid grid;
  std::vector<int> free;  // #V, number among the free nodes or -1
  int unknowns = 0;
  Eigen::SparseMatrix<double>
      coupling;  // #unknowns x #V: minus the rows of the stiffness that meet anchored nodes
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
};

HarmonicSolver::HarmonicSolver(TissueMesh mesh) {
  const auto data = std::make_shared<Data>(std::move(mesh));
  const TissueMesh& m = data->mesh;
  bool anchored = false;
  for (const TissueAnchor& anchor : m.anchors) {
    const bool free = anchor.kind == TissueAnchor::Kind::free;
    data->free.push_back(free ? data->unknowns++ : -1);
    anchored = anchored || !free;
  }
  if (!anchored) throw UnfitError("interior warp: no node of the tissue lies on skin or bone");
  std::vector<Eigen::Triplet<double>> inner, outer;
  for (Eigen::Index t = 0; t < m.T.rows(); ++t) {
    const Gradients g = gradients(m.V, m.T.row(t));
    if (!(g.volume > 0)) continue;
    const Eigen::Matrix4d K = g.volume * g.of * g.of.transpose();
    for (int a = 0; a < 4; ++a) {
      const int row = data->free[m.T(t, a)];
      if (row < 0) continue;
      for (int b = 0; b < 4; ++b) {
        const int column = data->free[m.T(t, b)];
        if (column >= 0)
          inner.emplace_back(row, column, K(a, b));
        else
          outer.emplace_back(row, m.T(t, b), -K(a, b));
      }
    }
  }
  Eigen::SparseMatrix<double> stiffness(data->unknowns, data->unknowns);
  stiffness.setFromTriplets(inner.begin(), inner.end());
  data->coupling.resize(data->unknowns, m.V.rows());
  data->coupling.setFromTriplets(outer.begin(), outer.end());
  if (data->unknowns > 0) {
    data->factor.compute(stiffness);
    if (data->factor.info() != Eigen::Success)
      throw UnfitError(
          "interior warp: the tissue's system cannot be solved; is a part of it without anchors?");
  }
  data_ = data;
}

const TissueMesh& HarmonicSolver::mesh() const { return data_->mesh; }

Points HarmonicSolver::move_nodes(const BodyPair& pair) const {
  const TissueMesh& m = data_->mesh;
  Points shifts = Points::Zero(m.V.rows(), 3);
  for (Eigen::Index n = 0; n < m.V.rows(); ++n) {
    const TissueAnchor& anchor = m.anchors[n];
    if (anchor.kind != TissueAnchor::Kind::free) shifts.row(n) = anchor_shift(anchor, pair);
  }
  if (data_->unknowns > 0) {
    const Eigen::MatrixXd solved = data_->factor.solve(Eigen::MatrixXd(data_->coupling * shifts));
    for (Eigen::Index n = 0; n < m.V.rows(); ++n)
      if (const int row = data_->free[n]; row >= 0) shifts.row(n) = solved.row(row);
  }
  return m.V + shifts;
}

InteriorMap HarmonicSolver::map_to(Points nodes) const {
  if (nodes.rows() != data_->mesh.V.rows())
    throw std::invalid_argument("interior warp: another number of nodes than the mesh has");
  return [data = data_, nodes = std::move(nodes)](const Vec3& p) -> Vec3 {
    Vec4 w;
    const int t = data->grid.find(p, w);
    if (t < 0) return p;
    Vec3 shift = Vec3::Zero();
    for (int k = 0; k < 4; ++k) {
      const int n = data->mesh.T(t, k);
      shift += w[k] * (nodes.row(n) - data->mesh.V.row(n)).transpose();
    }
    return p + shift;
  };
}

InteriorMap rbf_map(const BodyPair& pair, const RbfOptions& options) {
  std::vector<Vec3> from, to;
  const auto add = [&](const Points& before, const Points& after, int i) {
    from.emplace_back(before.row(i));
    to.emplace_back(after.row(i));
  };
  const TriMesh skin{*pair.skin_before, {}};
  for (const int i : surface_samples(skin, options.skin_points))
    add(*pair.skin_before, *pair.skin_after, i);
  const int each =
      std::max(2, options.bone_points / std::max<int>(1, int(pair.bones_before->size())));
  // m: samples of touching bones may lie in one place and go different ways
  constexpr double kApart = 3e-3;
  for (std::size_t b = 0; b < pair.bones_before->size(); ++b) {
    const Points &before = (*pair.bones_before)[b].mesh.V, &after = (*pair.bones_after)[b].mesh.V;
    for (const int i : surface_samples((*pair.bones_before)[b].mesh, each)) {
      const Vec3 p = before.row(i);
      if (std::ranges::none_of(from, [&](const Vec3& q) { return (p - q).norm() < kApart; }))
        add(before, after, i);
    }
  }
  const Eigen::Index n = from.size();
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + 4, n + 4),
                  wanted = Eigen::MatrixXd::Zero(n + 4, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3& p = from[i];
    for (Eigen::Index j = 0; j < n; ++j) system(i, j) = std::pow((p - from[j]).norm(), 3);
    system.row(i).tail<4>() << 1, p.x(), p.y(), p.z();
    system.col(i).tail<4>() = system.row(i).tail<4>().transpose();
    wanted.row(i) = (to[i] - p).transpose();
  }
  Eigen::MatrixXd weights = solve_lu_columns(system, wanted);
  if (!weights.allFinite())
    throw UnfitError("interior warp: samples of skin and bones lie in one place");
  return [from = std::move(from), weights = std::move(weights)](const Vec3& p) -> Vec3 {
    Eigen::RowVector3d shift =
        weights.row(weights.rows() - 4) + p.transpose() * weights.bottomRows<3>();
    for (std::size_t i = 0; i < from.size(); ++i) {
      const double r2 = (p - from[i]).squaredNorm();
      shift += r2 * std::sqrt(r2) * weights.row(i);
    }
    return p + shift.transpose();
  };
}

}  // namespace ecorche::inline v1
