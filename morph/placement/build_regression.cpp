#include "morph/placement/build_regression.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "anatomy/compute/cholesky.h"

namespace ecorche::inline v1 {
namespace {

// Ridge: features of less variance have little weight. Larger: bones follow the build less;
// smaller: they follow noise of the examples.
constexpr double kRidge = 2e-3;

}  // namespace

std::vector<double> build_features(const NamedPoints& centres, double stature) {
  const auto at = [&](const char* name) { return centres.at(name); };
  const Vec3 pelvis = at("pelvis");
  const auto apart = [&](const char* a, const char* b) { return (at(a) - at(b)).norm(); };
  std::vector<double> lengths{stature,
                              std::abs(at("shoulder").x() - pelvis.x()),
                              std::abs(at("hip").x() - pelvis.x()),
                              (at("c7") - pelvis).norm(),
                              apart("shoulder", "elbow"),
                              apart("hip", "knee"),
                              apart("wrist", "mcp3"),
                              apart("mcp2", "mcp5"),
                              apart("ankle", "mtp2"),
                              apart("mtp1", "mtp5"),
                              apart("head", "c7")};
  for (double& length : lengths) length = std::log(std::max(length, 1e-3));
  // Proportions: all but the first relative to stature.
  for (size_t k = 1; k < lengths.size(); ++k) lengths[k] -= lengths[0];
  return lengths;
}

BuildPrior learn_build(const std::vector<double>& own, const FitRules& rules,
                       const std::vector<BuildExample>& examples) {
  if (examples.empty()) throw std::invalid_argument("learn_build: no examples");
  const Eigen::Index n = own.size();
  const Eigen::Index outputs = Eigen::Index(rules.groups.size()) * BoneMap::way_count;
  Eigen::MatrixXd X(examples.size(), n), Y = Eigen::MatrixXd::Zero(X.rows(), outputs);
  for (size_t e = 0; e < examples.size(); ++e) {
    const Eigen::Index row = e;
    for (Eigen::Index k = 0; k < n; ++k) X(row, k) = examples[e].features[k] - own[k];
    for (size_t g = 0; g < rules.groups.size(); ++g)
      for (int w = 0; w < BoneMap::way_count; ++w)
        if (rules.groups[g].freedom[w] > 0)
          Y(row, Eigen::Index(g) * BoneMap::way_count + w) = deviation(
              examples[e].placed[g], examples[e].expected[g], static_cast<BoneMap::Way>(w));
  }
  const Eigen::MatrixXd H = X.transpose() * X + kRidge * Eigen::MatrixXd::Identity(n, n);
  BuildPrior prior;
  prior.own = own;
  for (Eigen::Index k = 0; k < n; ++k) {
    prior.low.push_back(std::min(0.0, X.col(k).minCoeff()));
    prior.high.push_back(std::max(0.0, X.col(k).maxCoeff()));
  }
  prior.weights = solve_ldlt_columns(H, X.transpose() * Y).transpose();
  return prior;
}

void apply_build(const BuildPrior& prior, const std::vector<double>& features, int group,
                 BoneMap& map) {
  for (int w = 0; w < BoneMap::way_count; ++w) {
    double step = 0;
    for (size_t k = 0; k < features.size(); ++k)
      step += prior.weights(Eigen::Index(group) * BoneMap::way_count + w, Eigen::Index(k)) *
              std::clamp(features[k] - prior.own[k], prior.low[k], prior.high[k]);
    if (step != 0) map.move(static_cast<BoneMap::Way>(w), step);
  }
}

}  // namespace ecorche::inline v1
