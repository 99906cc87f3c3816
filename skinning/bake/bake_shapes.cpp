#include "skinning/bake/bake_shapes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/eigenvectors.h"

namespace ecorche::inline v1 {
namespace {

using Mat3f = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::VectorXf;

constexpr float kLeastWeightBakeShapes = 0.3f,
                kMostWeight = 8;      // of a vertex in a frame, to the median
constexpr float kNearly = 1e-3f;      // m; weights do not rise for smaller errors
constexpr float kNothing = 2e-5f;     // m; a vertex with smaller errors in all frames has no shape
constexpr double kShapeRidge = 1e-3;  // regularisation of a shape's offsets, a frame

Mat3f blend_of(const FrameResidual& frame, Index i) {
  return Eigen::Map<const Mat3f>(frame.blend.row(i).data());
}

// Each shape in the world of one frame. 3 #V x #shapes
MatrixXf posed_shapes(const Shapes& shapes, const FrameResidual& frame) {
  MatrixXf out(shapes.offsets.rows(), shapes.offsets.cols());
  for (Index m = 0; m < out.cols(); ++m)
    for (Index i = 0; i < frame.residual.rows(); ++i)
      out.col(m).segment<3>(3 * i) = blend_of(frame, i) * shapes.offsets.col(m).segment<3>(3 * i);
  return out;
}

VectorXf flat(const Rows3f& rows) { return Eigen::Map<const VectorXf>(rows.data(), rows.size()); }

VectorXf solve_curves(const MatrixXf& shapes, const VectorXf& left, const VectorXf& weights) {
  MatrixXf scaled = shapes;
  VectorXf wanted = left;
  for (Index i = 0; i < weights.size(); ++i) {
    scaled.middleRows<3>(3 * i) *= weights[i];
    wanted.segment<3>(3 * i) *= weights[i];
  }
  Eigen::MatrixXd gram = (scaled.transpose() * scaled).cast<double>();
  gram.diagonal().array() += 1e-6 * gram.trace() / double(gram.rows()) + 1e-18;
  return solve_ldlt<Eigen::Dynamic>(gram, (scaled.transpose() * wanted).cast<double>())
      .cast<float>();
}

VectorXf lengths(const VectorXf& rows) {
  VectorXf out(rows.size() / 3);
  for (Index i = 0; i < out.size(); ++i) out[i] = rows.segment<3>(3 * i).norm();
  return out;
}

float quantile(std::vector<float> values, double share) {
  const std::size_t at = std::min(values.size() - 1, std::size_t(share * double(values.size())));
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(at), values.end());
  return values[at];
}

Shapes principal_shapes(const std::vector<FrameResidual>& frames, int most) {
  const Index n = Index(frames.size()), rows = 3 * frames[0].residual.rows();
  MatrixXf turned(rows, n);
  for (Index f = 0; f < n; ++f)
    for (Index i = 0; i < rows / 3; ++i)
      turned.col(f).segment<3>(3 * i) =
          blend_of(frames[f], i).transpose() * frames[f].residual.row(i).transpose();
  const SymmetricEigen<Eigen::Dynamic> gram =
      symmetric_eigen<Eigen::Dynamic>((turned.transpose() * turned).cast<double>());
  const double smallest = 1e-9 * std::max(gram.values[n - 1], 1e-15);
  Index count = 0;
  while (count < std::min<Index>(most, n) && gram.values[n - 1 - count] > smallest) ++count;
  MatrixXf directions(n, count);
  for (Index m = 0; m < count; ++m) {
    const Eigen::VectorXd v = gram.vectors.col(n - 1 - m);
    // the offsets where the curve, v, is largest
    directions.col(m) = (v * v.cwiseAbs().maxCoeff()).cast<float>();
  }
  return {turned * directions};
}

class Fitter {
 public:
  Fitter(const std::vector<FrameResidual>& frames, Shapes shapes)
      : frames_(frames),
        count_(Index(frames.size())),
        vertices_(frames[0].residual.rows()),
        shapes_(std::move(shapes)),
        curves_(shapes_.offsets.cols(), count_),
        weights_(MatrixXf::Ones(vertices_, count_)),
        errors_(vertices_, count_) {
    VectorXf most = VectorXf::Zero(vertices_);
    for (const FrameResidual& frame : frames) most = most.cwiseMax(frame.residual.rowwise().norm());
    for (Index i = 0; i < vertices_; ++i) moves_.push_back(most[i] > kNothing);
  }

  Shapes run(int rounds) {
    Shapes best = shapes_;
    float least = -1;
    for (int round = 0; round <= rounds; ++round) {
      find_curves();
      const float most = errors_.maxCoeff();
      if (least < 0 || most < least) least = most, best = shapes_;
      if (round == rounds || most <= kNothing) break;
      if (round > 0) weigh();
      find_shapes();
    }
    return best;
  }

 private:
  void find_curves() {
    tbb::parallel_for(Index{0}, count_, [&](Index f) {
      const FrameResidual& frame = frames_[f];
      const MatrixXf here = posed_shapes(shapes_, frame);
      const VectorXf left = flat(frame.residual);
      curves_.col(f) = solve_curves(here, left, weights_.col(f));
      errors_.col(f) = lengths(left - here * curves_.col(f));
    });
    for (Index m = 0; m < curves_.rows(); ++m) {
      const float reach = std::max(curves_.row(m).cwiseAbs().maxCoeff(), 1e-12f);
      curves_.row(m) /= reach;
      shapes_.offsets.col(m) *= reach;
    }
  }

  void weigh() {
    const std::vector<float> errors(errors_.data(), errors_.data() + errors_.size());
    const float level = std::max(quantile(errors, 0.999), kNearly);
    weights_.array() *= (errors_.array() / level).max(0.5f).min(2.0f).sqrt();
    weights_ /=
        quantile(std::vector<float>(weights_.data(), weights_.data() + weights_.size()), 0.5);
    weights_ = weights_.cwiseMax(kLeastWeightBakeShapes).cwiseMin(kMostWeight);
  }

  // The offsets of a vertex in all shapes at once, by its normal equations: products of the curves,
  // weighted by the frames' maps of offsets.
  void find_shapes() {
    const Index n = curves_.rows(), pairs = n * (n + 1) / 2;
    MatrixXf products(count_, pairs);
    for (Index a = 0, pair = 0; a < n; ++a)
      for (Index b = 0; b <= a; ++b, ++pair)
        products.col(pair) = curves_.row(a).cwiseProduct(curves_.row(b)).transpose();
    tbb::parallel_for(Index{0}, vertices_, [&](Index i) {
      if (!moves_[i]) return shapes_.offsets.middleRows<3>(3 * i).setZero(), void();
      MatrixXf squares(9, count_), turned(count_, 3);
      for (Index f = 0; f < count_; ++f) {
        const FrameResidual& frame = frames_[f];
        const Mat3f A = weights_(i, f) * blend_of(frame, i), AA = A.transpose() * A;
        squares.col(f) = Eigen::Map<const Eigen::Matrix<float, 9, 1>>(AA.data());
        turned.row(f) =
            weights_(i, f) * (A.transpose() * frame.residual.row(i).transpose()).transpose();
      }
      const MatrixXf blocks = squares * products,
                     right = curves_ * turned;  // 9 x #pairs, #shapes x 3
      Eigen::MatrixXd H(3 * n, 3 * n);
      Eigen::VectorXd g(3 * n);
      for (Index a = 0, pair = 0; a < n; ++a) {
        for (Index b = 0; b <= a; ++b, ++pair)
          H.block<3, 3>(3 * a, 3 * b) =
              Eigen::Map<const Mat3f>(blocks.col(pair).data()).cast<double>();
        g.segment<3>(3 * a) = right.row(a).transpose().cast<double>();
      }
      H.diagonal().array() += kShapeRidge * double(count_);
      const Eigen::VectorXd offsets = solve_llt(H, g);
      for (Index m = 0; m < n; ++m)
        shapes_.offsets.col(m).segment<3>(3 * i) = offsets.segment<3>(3 * m).cast<float>();
    });
  }

  const std::vector<FrameResidual>& frames_;
  const Index count_, vertices_;
  Shapes shapes_;
  MatrixXf curves_, weights_, errors_;  // #shapes, #V, #V x #frames
  std::vector<char> moves_;
};

}  // namespace

Shapes fit_shapes(const std::vector<FrameResidual>& frames, int most, int rounds,
                  const Shapes& start) {
  Shapes begin = start.offsets.cols() > 0 ? start : principal_shapes(frames, most);
  if (begin.offsets.cols() == 0) return begin;
  return Fitter(frames, std::move(begin)).run(rounds);
}

}  // namespace ecorche::inline v1
