#include "skinning/bake/bake_polish.h"

#include <tbb/parallel_for.h>

#include "anatomy/compute/cholesky.h"
#include "skinning/bake/bake_cost.h"

namespace ecorche::inline v1 {
namespace {

using Eigen::Index;

constexpr double kFine = 3.5e-3;  // m; a vertex with smaller errors in all frames is left as it is
constexpr int kRoundsBakePolish = 4, kHalvings = 4;
constexpr double kRidge = 1e-3;  // regularisation of a change of the offsets, a frame

// One vertex in all frames.
class Polisher {
 public:
  Polisher(const std::vector<FrameResidual>& frames, const Eigen::MatrixXd& curves,
           const Eigen::MatrixXd& products, Index vertex)
      : curves_(curves), products_(products), blends_(frames.size()), left_(3, curves.cols()) {
    for (std::size_t f = 0; f < frames.size(); ++f) {
      blends_[f] = Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(
                       frames[f].blend.row(vertex).data())
                       .cast<double>();
      left_.col(Index(f)) = frames[f].residual.row(vertex).transpose().cast<double>();
    }
  }

  // 3 x #frames
  Eigen::MatrixXd off(const Eigen::MatrixXd& offsets) const {
    Eigen::MatrixXd out = offsets * curves_;
    for (std::size_t f = 0; f < blends_.size(); ++f) {
      const Vec3 at_rest = out.col(Index(f));
      out.col(Index(f)) = blends_[f] * at_rest - left_.col(Index(f));
    }
    return out;
  }

  // `offsets`: 3 x #shapes
  void polish(Eigen::MatrixXd& offsets) const {
    Eigen::MatrixXd off = this->off(offsets);
    if (off.colwise().norm().maxCoeff() < kFine) return;
    double now = cost_of(off.colwise().norm().transpose());
    for (int round = 0; round < kRoundsBakePolish; ++round) {
      const Eigen::MatrixXd by = step(off);
      bool better = false;
      double length = 1;
      for (int halving = 0; halving < kHalvings && !better; ++halving, length /= 2) {
        const Eigen::MatrixXd moved = offsets + length * by;
        off = this->off(moved);
        const double then = cost_of(off.colwise().norm().transpose());
        if (!(then < now)) continue;
        better = true;
        now = then;
        offsets = moved;
      }
      if (!better) return;
    }
  }

 private:
  Eigen::MatrixXd step(const Eigen::MatrixXd& off) const {
    const Index n = curves_.rows(), count = curves_.cols();
    Eigen::MatrixXd squares(9, count), slopes(3, count);
    for (Index f = 0; f < count; ++f) {
      const CostRoot cost = cost_root(off.col(f), false);
      const Mat3 A = cost.root * blends_[f], AA = A.transpose() * A;
      squares.col(f) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(AA.data());
      for (int k = 0; k < 3; ++k) slopes(k, f) = A.col(k).dot(cost.rest);
    }
    const Eigen::MatrixXd blocks = squares * products_,
                          right = slopes * curves_.transpose();  // 9 x #pairs, 3 x #shapes
    Eigen::MatrixXd H(3 * n, 3 * n);
    for (Index a = 0, pair = 0; a < n; ++a)
      for (Index b = 0; b <= a; ++b, ++pair)
        H.block<3, 3>(3 * a, 3 * b) = Eigen::Map<const Mat3>(blocks.col(pair).data());
    H.diagonal().array() += kRidge * double(count);
    const Eigen::VectorXd g = -right.reshaped();
    const Eigen::VectorXd by = solve_llt(H, g);
    return by.reshaped(3, n);
  }

  const Eigen::MatrixXd &curves_, &products_;
  std::vector<Mat3> blends_;
  Eigen::MatrixXd left_;
};

}  // namespace

void polish_shapes(const std::vector<FrameResidual>& frames, const Eigen::MatrixXd& curves,
                   Shapes& shapes) {
  const Index n = curves.rows();
  if (n == 0) return;
  Eigen::MatrixXd products(curves.cols(), n * (n + 1) / 2);
  for (Index a = 0, pair = 0; a < n; ++a)
    for (Index b = 0; b <= a; ++b, ++pair)
      products.col(pair) = curves.row(a).cwiseProduct(curves.row(b)).transpose();
  tbb::parallel_for(Index{0}, frames[0].residual.rows(), [&](Index i) {
    const Polisher vertex(frames, curves, products, i);
    Eigen::MatrixXd offsets(3, n);
    for (Index m = 0; m < n; ++m)
      offsets.col(m) = shapes.offsets.col(m).segment<3>(3 * i).cast<double>();
    vertex.polish(offsets);
    for (Index m = 0; m < n; ++m)
      shapes.offsets.col(m).segment<3>(3 * i) = offsets.col(m).cast<float>();
  });
}

}  // namespace ecorche::inline v1
