#include "skinning/bake/bake_weights.h"

#include <algorithm>

#include "anatomy/compute/linear_systems.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kNone = 1e-9;

// The minimum over the joints of `active`, without regard to signs.
Eigen::VectorXd on_plane(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                         const std::vector<int>& active) {
  const Eigen::Index n = active.size();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::VectorXd right(n + 1);
  const double scale = H.diagonal().maxCoeff();  // the last row in units of the others
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k) K(i, k) = H(active[i], active[k]);
    K(i, n) = K(n, i) = scale;
    right[i] = g[active[i]];
  }
  right[n] = scale;
  return solve_lu(K, right).head(n);
}

double cost(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& w) {
  return 0.5 * w.dot(H * w) - g.dot(w);
}

// Active set over `allowed`, from the best single joint on.
Eigen::VectorXd solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                      const std::vector<int>& allowed) {
  Eigen::VectorXd w = Eigen::VectorXd::Zero(H.rows());
  const int best = *std::min_element(allowed.begin(), allowed.end(), [&](int a, int b) {
    return 0.5 * H(a, a) - g[a] < 0.5 * H(b, b) - g[b];
  });
  w[best] = 1;
  std::vector<int> active{best};
  for (int round = 0; round < 4 * int(allowed.size()); ++round) {
    const Eigen::VectorXd slope = H * w - g;
    const double level = slope.dot(w);  // the slope of those that are in, as their weights sum to 1
    int enters = -1;
    double steepest = -1e-10 * H.diagonal().maxCoeff();
    for (int j : allowed)
      if (w[j] == 0 && slope[j] - level < steepest) steepest = slope[j] - level, enters = j;
    if (enters < 0) break;
    active.push_back(enters);
    while (true) {
      const Eigen::VectorXd s = on_plane(H, g, active);
      double step = 1;
      for (std::size_t i = 0; i < active.size(); ++i)
        if (const double v = s[i]; v <= kNone)
          step = std::min(step, w[active[i]] / std::max(w[active[i]] - v, 1e-300));
      for (std::size_t i = 0; i < active.size(); ++i) w[active[i]] += step * (s[i] - w[active[i]]);
      if (step >= 1) break;
      const auto out = [&](int j) {
        if (w[j] > kNone) return false;
        w[j] = 0;
        return true;
      };
      active.erase(std::remove_if(active.begin(), active.end(), out), active.end());
      if (active.empty()) return w;  // cannot be: the weights sum to 1
    }
  }
  return w;
}

}  // namespace

Eigen::VectorXd simplex_weights(const Eigen::MatrixXd& G, const Eigen::VectorXd& start,
                                double ridge, int most) {
  const Eigen::MatrixXd H = 2 * (G + ridge * Eigen::MatrixXd::Identity(G.rows(), G.cols()));
  const Eigen::VectorXd g = 2 * ridge * start;
  std::vector<int> allowed;
  for (int j = 0; j < int(G.rows()); ++j) allowed.push_back(j);
  Eigen::VectorXd w = solve(H, g, allowed);
  while ((w.array() > 0).count() > most) {
    allowed.clear();
    for (int j = 0; j < int(w.size()); ++j)
      if (w[j] > 0) allowed.push_back(j);
    Eigen::VectorXd least;
    for (int dropped : allowed) {
      std::vector<int> rest = allowed;
      rest.erase(std::find(rest.begin(), rest.end(), dropped));
      const Eigen::VectorXd without = solve(H, g, rest);
      if (least.size() == 0 || cost(H, g, without) < cost(H, g, least)) least = without;
    }
    w = least;
  }
  return w / w.sum();
}

}  // namespace ecorche::inline v1
