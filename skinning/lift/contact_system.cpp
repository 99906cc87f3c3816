#include "skinning/lift/contact_system.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <vector>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/cross_matrix.h"

namespace ecorche::inline v1 {
namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Arm = Eigen::Matrix<double, 3, 6>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Sparse = Eigen::SparseMatrix<double>;

int place_of(const Sparse& A, int row, int column) {
  const int* begin = A.innerIndexPtr() + A.outerIndexPtr()[column];
  const int* end = A.innerIndexPtr() + A.outerIndexPtr()[column + 1];
  return int(std::lower_bound(begin, end, row) - A.innerIndexPtr());
}

}  // namespace

struct ContactSystem::Impl {
  struct JointContact {
    int node = 0, joint = 0;
    Arm rows = Arm::Zero();
  };

  // Places of a symmetric block's values in the lower half of the matrix, column by column.
  struct BlockPlaces {
    std::array<int, 9> at{};
  };

  const Sheet* sheet = nullptr;
  int nodes = 0, freedoms = 0;
  Sparse A;
  std::vector<BlockPlaces> node_places, spring_places;
  std::vector<Mat3> node_blocks, spring_blocks;
  Eigen::VectorXd node_b;
  Eigen::MatrixXd body_A;
  Eigen::VectorXd body_b;
  std::vector<Mat6> joint_A;
  std::vector<Vec6> joint_b;
  std::vector<char> joint_used;
  std::vector<JointContact> couplings;         // a node and a joint, in order of use
  std::vector<std::vector<int>> couplings_of;  // #nodes, into couplings
  Eigen::SimplicialLLT<Sparse, Eigen::Lower> factor;
  Rows right;

  void make_pattern() {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < nodes; ++i)
      for (int c = 0; c < 3; ++c)
        for (int r = c; r < 3; ++r) entries.emplace_back(3 * i + r, 3 * i + c, 1.0);
    for (const SheetSpring& spring : sheet->springs)
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) entries.emplace_back(3 * spring.a + r, 3 * spring.b + c, 1.0);
    A.resize(3 * nodes, 3 * nodes);
    A.setFromTriplets(entries.begin(), entries.end());
    A.makeCompressed();
    node_places.resize(std::size_t(nodes));
    for (int i = 0; i < nodes; ++i)
      for (int c = 0; c < 3; ++c)
        for (int r = c; r < 3; ++r)
          node_places[std::size_t(i)].at[std::size_t(3 * c + r)] =
              place_of(A, 3 * i + r, 3 * i + c);
    for (const SheetSpring& spring : sheet->springs) {
      BlockPlaces places;
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
          places.at[std::size_t(3 * c + r)] = place_of(A, 3 * spring.a + r, 3 * spring.b + c);
      spring_places.push_back(places);
    }
    node_blocks.resize(std::size_t(nodes));
    spring_blocks.resize(sheet->springs.size());
    couplings_of.resize(std::size_t(nodes));
    factor.analyzePattern(A);
  }

  void fill() {
    double* value = A.valuePtr();
    for (std::size_t i = 0; i < node_blocks.size(); ++i)
      for (int c = 0; c < 3; ++c)
        for (int r = c; r < 3; ++r)
          value[node_places[i].at[std::size_t(3 * c + r)]] = node_blocks[i](r, c);
    for (std::size_t e = 0; e < spring_blocks.size(); ++e)
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
          value[spring_places[e].at[std::size_t(3 * c + r)]] = spring_blocks[e](r, c);
  }

  Arm& coupling(int node, int joint) {
    for (const int k : couplings_of[std::size_t(node)])
      if (couplings[std::size_t(k)].joint == joint) return couplings[std::size_t(k)].rows;
    couplings_of[std::size_t(node)].push_back(int(couplings.size()));
    couplings.push_back({node, joint, Arm::Zero()});
    return couplings.back().rows;
  }

  void add_joints(const BodyFrames& frames) {
    for (std::size_t j = 0; j < joint_used.size(); ++j) {
      if (!joint_used[j]) continue;
      const Eigen::MatrixXd& J = frames.jacobian[j];
      body_A.noalias() += J.transpose() * (joint_A[j] * J);
      body_b.noalias() += J.transpose() * joint_b[j];
    }
  }

  // Columns of the coupling and the right side, in the factor's order.
  void fill_right(const BodyFrames& frames) {
    const auto& order = factor.permutationP().indices();
    right.setZero(3 * nodes, freedoms + 1);
    for (const JointContact& each : couplings) {
      const Rows block = each.rows * frames.jacobian[std::size_t(each.joint)];
      for (int c = 0; c < 3; ++c)
        right.row(order[3 * each.node + c]).head(freedoms) += block.row(c);
    }
    for (int i = 0; i < 3 * nodes; ++i) right(order[i], freedoms) = node_b[i];
  }

  // right = L^-1 right
  void solve_lower(const Sparse& L) {
    for (int c = 0; c < L.cols(); ++c) {
      Sparse::InnerIterator it(L, c);
      right.row(c) /= it.value();
      for (++it; it; ++it) right.row(it.row()) -= it.value() * right.row(c);
    }
  }

  static void solve_upper(const Sparse& L, Eigen::VectorXd& x) {
    for (int c = int(L.cols()) - 1; c >= 0; --c) {
      Sparse::InnerIterator it(L, c);
      const double corner = it.value();
      double sum = x[c];
      for (++it; it; ++it) sum -= it.value() * x[it.row()];
      x[c] = sum / corner;
    }
  }
};

ContactSystem::ContactSystem(const Sheet* sheet, int freedoms) : impl_(std::make_unique<Impl>()) {
  impl_->sheet = sheet;
  impl_->freedoms = freedoms;
  impl_->nodes = sheet ? int(sheet->mesh.V.rows()) : 0;
  if (sheet) impl_->make_pattern();
}
ContactSystem::~ContactSystem() = default;
ContactSystem::ContactSystem(ContactSystem&&) noexcept = default;
ContactSystem& ContactSystem::operator=(ContactSystem&&) noexcept = default;

void ContactSystem::clear() {
  std::ranges::fill(impl_->node_blocks, Mat3::Zero());
  std::ranges::fill(impl_->spring_blocks, Mat3::Zero());
  impl_->node_b.setZero(3 * impl_->nodes);
  impl_->body_A.setZero(impl_->freedoms, impl_->freedoms);
  impl_->body_b.setZero(impl_->freedoms);
  std::ranges::fill(impl_->joint_used, 0);
  impl_->couplings.clear();
  for (std::vector<int>& list : impl_->couplings_of) list.clear();
}

void ContactSystem::add_body(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  impl_->body_A += A;
  impl_->body_b += b;
}

void ContactSystem::add_node(int node, const Mat3& A, const Vec3& b) {
  impl_->node_blocks[std::size_t(node)] += A;
  impl_->node_b.segment<3>(3 * node) += b;
}

void ContactSystem::add_spring(int spring, const Mat3& A, const Vec3& b) {
  const SheetSpring& ends = impl_->sheet->springs[std::size_t(spring)];
  add_node(ends.a, A, b);
  add_node(ends.b, A, -b);
  impl_->spring_blocks[std::size_t(spring)] -= A;
}

void ContactSystem::add_contact(int joint, const Vec3& arm, int triangle, const Vec3& corners,
                                const Mat3& B, const Vec3& r) {
  Impl& in = *impl_;
  if (in.joint_used.size() <= std::size_t(joint)) {
    in.joint_used.resize(std::size_t(joint) + 1, 0);
    in.joint_A.resize(std::size_t(joint) + 1);
    in.joint_b.resize(std::size_t(joint) + 1);
  }
  if (!in.joint_used[std::size_t(joint)]) {
    in.joint_used[std::size_t(joint)] = 1;
    in.joint_A[std::size_t(joint)].setZero();
    in.joint_b[std::size_t(joint)].setZero();
  }
  Arm L;
  L << -cross_matrix(arm), Mat3::Identity();
  const Arm BL = B * L;
  in.joint_A[std::size_t(joint)].noalias() += L.transpose() * BL;
  in.joint_b[std::size_t(joint)].noalias() += L.transpose() * r;
  if (triangle < 0) return;
  const auto& edges = in.sheet->edges_of[std::size_t(triangle)];
  for (int k = 0; k < 3; ++k) {
    const int node = in.sheet->mesh.F(triangle, k);
    add_node(node, corners[k] * corners[k] * B, -corners[k] * r);
    in.spring_blocks[std::size_t(edges[std::size_t(k)])] += corners[k] * corners[(k + 1) % 3] * B;
    in.coupling(node, joint) -= corners[k] * BL;
  }
}

void ContactSystem::solve(const BodyFrames& frames, Points& nodes, Eigen::VectorXd& body) {
  Impl& in = *impl_;
  in.add_joints(frames);
  if (in.nodes == 0) {
    body = solve_llt(in.body_A, in.body_b);
    return;
  }
  in.fill();
  in.factor.factorize(in.A);
  const Sparse& L = in.factor.matrixL().nestedExpression();
  in.fill_right(frames);
  in.solve_lower(L);
  const auto Y = in.right.leftCols(in.freedoms);
  Eigen::VectorXd y = in.right.col(in.freedoms);
  Eigen::MatrixXd S = in.body_A;
  S.noalias() -= Y.transpose() * Y;
  body = solve_llt(S, in.body_b - Y.transpose() * y);
  y.noalias() -= Y * body;
  Impl::solve_upper(L, y);
  nodes.resize(in.nodes, 3);
  const auto& order = in.factor.permutationP().indices();
  for (int i = 0; i < in.nodes; ++i)
    for (int c = 0; c < 3; ++c) nodes(i, c) = y[order[3 * i + c]];
}

}  // namespace ecorche::inline v1
