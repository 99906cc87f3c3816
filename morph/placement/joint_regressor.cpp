#include "morph/placement/joint_regressor.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "anatomy/compute/linear_systems.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kRing = 120;      // vertices of a centre, at most
constexpr int kNearest = 24;    // the nearest so many say how far away the skin is,
constexpr double kReach = 1.8;  // and the ring reaches so many times as far
// m: cost of a weight against a metre of error. Larger: centres are learned worse; smaller: they
// follow noise of the skin.
constexpr double kSmallness = 1.5e-3;

// Vertices around a centre, evenly thinned; for a point of the middle, together with their mirror
// images.
std::vector<int> ring_of(const Points& skin, const Vec3& centre, const std::vector<int>& mirror,
                         bool middle) {
  const Eigen::VectorXd d2 = (skin.rowwise() - centre.transpose()).rowwise().squaredNorm();
  std::vector<int> order(skin.rows());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::pair(d2[a], a) < std::pair(d2[b], b); });
  const double reach = kReach * kReach * d2[order[kNearest - 1]];
  int count = kNearest;
  while (count < int(order.size()) && d2[order[count]] < reach) ++count;
  std::vector<int> out;
  for (int k = 0; k < std::min(count, kRing); ++k)
    out.push_back(order[static_cast<int64_t>(k) * count / std::min(count, kRing)]);
  if (middle) {
    const size_t n = out.size();
    for (size_t k = 0; k < n; ++k) out.push_back(mirror[out[k]]);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

CentreRegressor learn_centres(const std::vector<CentreExample>& examples,
                              const std::vector<int>& mirror) {
  if (examples.empty()) throw std::invalid_argument("learn_centres: no examples");
  CentreRegressor regressor;
  for (const auto& [name, centre] : examples[0].centres) {
    const bool middle = std::abs(centre.x()) < 1e-9;
    CentreRegressor::Row row;
    row.name = name;
    row.vertices = ring_of(examples[0].skin, centre, mirror, middle);
    const int n = row.vertices.size();
    // Minimise |X w - c|^2 over the examples + (smallness |w|)^2 n, subject to the first example
    // and the sum, exactly.
    Eigen::MatrixXd H = Eigen::MatrixXd::Identity(n, n) * (kSmallness * kSmallness * n);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    Eigen::MatrixXd C(4, n);
    for (size_t e = 0; e < examples.size(); ++e) {
      const auto known = examples[e].centres.find(name);
      if (known == examples[e].centres.end()) continue;
      Eigen::MatrixXd X(3, n);
      for (int k = 0; k < n; ++k) X.col(k) = examples[e].skin.row(row.vertices[k]).transpose();
      if (e == 0) {
        C.topRows(3) = X;
      } else {
        H += X.transpose() * X;
        g += X.transpose() * known->second;
      }
    }
    C.row(3).setOnes();
    Eigen::VectorXd d(4);
    d << centre, 1;
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + 4, n + 4);
    K.topLeftCorner(n, n) = H;
    K.topRightCorner(n, 4) = C.transpose();
    K.bottomLeftCorner(4, n) = C;
    Eigen::VectorXd rhs(n + 4);
    rhs << g, d;
    // The middle's three equations include x = 0, which symmetric rings meet of themselves: the
    // system may be singular there.
    Eigen::VectorXd w = solve_least_norm(K, rhs).head(n);
    if (middle) {
      Eigen::VectorXd even = w;
      for (int k = 0; k < n; ++k) {
        const int other =
            std::lower_bound(row.vertices.begin(), row.vertices.end(), mirror[row.vertices[k]]) -
            row.vertices.begin();
        even[k] = (w[k] + w[other]) / 2;
      }
      w = even;
    }
    row.weights.assign(w.data(), w.data() + n);
    regressor.rows.push_back(std::move(row));
  }
  return regressor;
}

NamedPoints joint_centres(const CentreRegressor& regressor, const Points& skin) {
  NamedPoints out;
  for (const auto& row : regressor.rows) {
    Vec3 sum = Vec3::Zero();
    for (size_t k = 0; k < row.vertices.size(); ++k)
      sum += row.weights[k] * skin.row(row.vertices[k]).transpose();
    out[row.name] = sum;
  }
  return out;
}

}  // namespace ecorche::inline v1
