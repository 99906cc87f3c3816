#include "morph/tissue/interior_interpolation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "anatomy/compute/cholesky.h"

namespace ecorche::inline v1 {
namespace {

// One vertex a cell of a grid, the first of each.
std::vector<int> thinned(const Points& skin) {
  constexpr double kCell = 0.02;  // m
  std::set<std::array<int, 3>> cells;
  std::vector<int> out;
  for (Eigen::Index v = 0; v < skin.rows(); ++v) {
    std::array<int, 3> cell{};
    for (int axis = 0; axis < 3; ++axis) cell[axis] = int(std::floor(skin(v, axis) / kCell));
    if (cells.insert(cell).second) out.push_back(int(v));
  }
  return out;
}

// Samples in blocks, so that the nearest of a point are found among few.
class Blocks {
 public:
  explicit Blocks(const Points& samples) : samples_(samples) {
    constexpr double kBlock = 0.1;  // m
    std::map<std::array<int, 3>, std::vector<int>> cells;
    for (Eigen::Index i = 0; i < samples.rows(); ++i) {
      std::array<int, 3> cell{};
      for (int axis = 0; axis < 3; ++axis) cell[axis] = int(std::floor(samples(i, axis) / kBlock));
      cells[cell].push_back(int(i));
    }
    for (auto& [_, held] : cells) {
      Eigen::AlignedBox3d box;
      for (const int i : held) box.extend(samples.row(i).transpose());
      blocks_.push_back({box, std::move(held)});
    }
  }

  // The `count` nearest to `p` with the squares of their distances, in any order.
  std::vector<std::pair<double, int>> nearest(const Vec3& p, std::size_t count) const {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t b = 0; b < blocks_.size(); ++b)
      order.emplace_back(blocks_[b].box.squaredExteriorDistance(p), b);
    std::ranges::sort(order);
    std::vector<std::pair<double, int>> near;
    for (const auto& [distance, b] : order) {
      if (near.size() >= count) {
        std::ranges::nth_element(near, near.begin() + std::ptrdiff_t(count) - 1);
        near.resize(count);
        if (distance > near.back().first) break;
      }
      for (const int i : blocks_[b].samples)
        near.emplace_back((samples_.row(i).transpose() - p).squaredNorm(), i);
    }
    std::ranges::nth_element(near, near.begin() + std::ptrdiff_t(count) - 1);
    near.resize(count);
    return near;
  }

 private:
  struct Block {
    Eigen::AlignedBox3d box;
    std::vector<int> samples;
  };
  const Points& samples_;
  std::vector<Block> blocks_;
};

void hang(const Points& samples, const Blocks& blocks, const Vec3& p, int* anchors,
          float* weights) {
  constexpr double kNearest = 2.5e-5;  // m^2: nearer anchors count alike
  constexpr double kRidge = 0.05;
  std::vector<std::pair<double, int>> near = blocks.nearest(p, SkinInterpolation::kAnchors);
  std::ranges::sort(
      near, {},
      &std::pair<double, int>::second);  // so that sums do not depend on how they were found
  std::array<double, SkinInterpolation::kAnchors> w{};
  Vec3 middle = Vec3::Zero();
  double sum = 0;
  for (std::size_t k = 0; k < w.size(); ++k) {
    w[k] = 1 / std::pow(near[k].first + kNearest, 2);
    sum += w[k];
    middle += w[k] * samples.row(near[k].second).transpose();
  }
  middle /= sum;
  Mat3 spread = Mat3::Zero();
  for (std::size_t k = 0; k < w.size(); ++k) {
    const Vec3 d = samples.row(near[k].second).transpose() - middle;
    spread += w[k] * d * d.transpose();
  }
  spread.diagonal().array() += kRidge * spread.trace();
  const Vec3 towards = solve_ldlt<3>(spread, p - middle);
  for (std::size_t k = 0; k < w.size(); ++k) {
    anchors[k] = near[k].second;
    weights[k] =
        float(w[k] * (1 / sum + towards.dot(samples.row(near[k].second).transpose() - middle)));
  }
}

Points rows_of(const Points& all, const std::vector<int>& rows) {
  Points out(rows.size(), 3);
  for (std::size_t i = 0; i < rows.size(); ++i) out.row(i) = all.row(rows[i]);
  return out;
}

}  // namespace

SkinInterpolation make_skin_interpolation(const Points& skin, const Points& inside) {
  SkinInterpolation out;
  out.samples = thinned(skin);
  if (int(out.samples.size()) < SkinInterpolation::kAnchors)
    throw std::invalid_argument("make_carrier: too few skin points");
  out.sampled = rows_of(skin, out.samples);
  out.inside = inside;
  Eigen::MatrixX4d ones(out.sampled.rows(), 4);
  ones << out.sampled, Eigen::VectorXd::Ones(out.sampled.rows());
  out.affine = (ones.transpose() * ones).ldlt().solve(ones.transpose());
  const auto size = std::size_t(inside.rows()) * SkinInterpolation::kAnchors;
  out.anchors.resize(size);
  out.weights.resize(size);
  const Blocks blocks(out.sampled);
  tbb::parallel_for(Eigen::Index{0}, inside.rows(), [&](Eigen::Index i) {
    const auto at = std::size_t(i) * SkinInterpolation::kAnchors;
    hang(out.sampled, blocks, inside.row(i), &out.anchors[at], &out.weights[at]);
  });
  return out;
}

void carry(const SkinInterpolation& carrier, const Points& changed_skin, Points& out) {
  const Points samples = rows_of(changed_skin, carrier.samples);
  const Eigen::Matrix<double, 4, 3> map = carrier.affine * samples;
  const Mat3 linear = map.topRows<3>().transpose();
  const Vec3 shift = map.row(3).transpose();
  const Points left =
      samples - ((carrier.sampled * linear.transpose()).rowwise() + shift.transpose());
  const Eigen::Index count = carrier.inside.rows();
  out.resize(count, 3);
  tbb::parallel_for(tbb::blocked_range<Eigen::Index>(0, count, 1024),
                    [&](const tbb::blocked_range<Eigen::Index>& range) {
                      for (Eigen::Index i = range.begin(); i < range.end(); ++i) {
                        Vec3 p = linear * carrier.inside.row(i).transpose() + shift;
                        const auto at = std::size_t(i) * SkinInterpolation::kAnchors;
                        for (std::size_t k = 0; k < SkinInterpolation::kAnchors; ++k)
                          p += double(carrier.weights[at + k]) *
                               left.row(carrier.anchors[at + k]).transpose();
                        out.row(i) = p.transpose();
                      }
                    });
}

}  // namespace ecorche::inline v1
