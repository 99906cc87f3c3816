#include "morph/carry_inside.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <oneapi/tbb/parallel_for.h>

namespace ecorche {
namespace {

// One vertex a cell of a grid, the first of each.
std::vector<int> thinned(const Points& skin) {
  constexpr double kCell = 0.02;  // m
  std::set<std::array<int, 3>> cells;
  std::vector<int> out;
  for (Eigen::Index v = 0; v < skin.rows(); ++v) {
    std::array<int, 3> cell{};
    for (int axis = 0; axis < 3; ++axis) cell[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor(skin(v, axis) / kCell));
    if (cells.insert(cell).second) out.push_back(static_cast<int>(v));
  }
  return out;
}

void hang(const Points& skin, const std::vector<int>& samples, const Vec3& p, int* vertices, float* weights) {
  std::vector<std::pair<double, int>> near;
  near.reserve(samples.size());
  for (int v : samples) near.emplace_back((skin.row(v).transpose() - p).squaredNorm(), v);
  std::nth_element(near.begin(), near.begin() + Carrier::kAnchors - 1, near.end());
  std::array<double, Carrier::kAnchors> w{};
  Vec3 middle = Vec3::Zero();
  double sum = 0;
  for (int k = 0; k < Carrier::kAnchors; ++k) {
    constexpr double kNearest = 2.5e-5;  // m^2: nearer anchors count alike
    w[static_cast<std::size_t>(k)] = 1 / std::pow(near[static_cast<std::size_t>(k)].first + kNearest, 2);
    sum += w[static_cast<std::size_t>(k)];
    middle += w[static_cast<std::size_t>(k)] * skin.row(near[static_cast<std::size_t>(k)].second).transpose();
  }
  middle /= sum;
  Mat3 spread = Mat3::Zero();
  for (int k = 0; k < Carrier::kAnchors; ++k) {
    const Vec3 d = skin.row(near[static_cast<std::size_t>(k)].second).transpose() - middle;
    spread += w[static_cast<std::size_t>(k)] * d * d.transpose();
  }
  spread.diagonal().array() += 1e-9 * spread.trace();
  const Vec3 towards = spread.ldlt().solve(p - middle);
  for (int k = 0; k < Carrier::kAnchors; ++k) {
    const auto& [_, v] = near[static_cast<std::size_t>(k)];
    vertices[k] = v;
    weights[k] = static_cast<float>(w[static_cast<std::size_t>(k)] * (1 / sum + towards.dot(skin.row(v).transpose() - middle)));
  }
}

}  // namespace

Carrier make_carrier(const Points& skin, const Points& inside) {
  const std::vector<int> samples = thinned(skin);
  if (static_cast<int>(samples.size()) < Carrier::kAnchors) throw std::invalid_argument("make_carrier: too few skin points");
  Carrier out;
  const auto size = static_cast<std::size_t>(inside.rows()) * Carrier::kAnchors;
  out.vertices.resize(size);
  out.weights.resize(size);
  tbb::parallel_for(Eigen::Index{0}, inside.rows(), [&](Eigen::Index i) {
    const auto at = static_cast<std::size_t>(i) * Carrier::kAnchors;
    hang(skin, samples, inside.row(i), &out.vertices[at], &out.weights[at]);
  });
  return out;
}

void carry(const Carrier& carrier, const Points& changed_skin, Points& out) {
  const auto count = static_cast<Eigen::Index>(carrier.vertices.size() / Carrier::kAnchors);
  out.resize(count, 3);
  tbb::parallel_for(tbb::blocked_range<Eigen::Index>(0, count, 1024), [&](const tbb::blocked_range<Eigen::Index>& range) {
    for (Eigen::Index i = range.begin(); i < range.end(); ++i) {
      Vec3 p = Vec3::Zero();
      const auto at = static_cast<std::size_t>(i) * Carrier::kAnchors;
      for (std::size_t k = 0; k < Carrier::kAnchors; ++k) p += static_cast<double>(carrier.weights[at + k]) * changed_skin.row(carrier.vertices[at + k]).transpose();
      out.row(i) = p.transpose();
    }
  });
}

}  // namespace ecorche
