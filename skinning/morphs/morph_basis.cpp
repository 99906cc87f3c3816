#include "skinning/morphs/morph_basis.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "skinning/morphs/turned_curves.h"

namespace ecorche::inline v1 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXf;

// Shapes that a basis grows to before it is condensed to half, over the most that are wanted.
// Larger: closer to the best shapes, and slower.
constexpr int kGrown = 4;
constexpr Index kFirstCapacity = 8;

double largest_offset(const VectorXf& offsets) {
  return std::sqrt(double(Eigen::Map<const Eigen::Matrix3Xf>(offsets.data(), 3, offsets.size() / 3)
                              .colwise()
                              .squaredNorm()
                              .maxCoeff()));
}

}  // namespace

MorphBasis::MorphBasis(Index vertices, const ShapeOptions& options)
    : options_(options), left_(3 * vertices) {
  if (vertices < 1) throw std::invalid_argument("MorphBasis: a mesh without vertices");
}

void MorphBasis::add(const VectorXf& offsets, const VectorXf& normals) {
  if (offsets.size() != left_.size() || (normals.size() != 0 && normals.size() != left_.size()))
    throw std::invalid_argument("MorphBasis: a frame of another mesh");
  if (count_ == kGrown * options_.most) condense();
  VectorXf curve = VectorXf::Zero(count_);
  left_ = offsets;
  for (int pass = 0; pass < 2 && count_ > 0; ++pass) {  // once more for what rounding leaves
    const VectorXf more = basis_.leftCols(count_).transpose() * left_;
    left_.noalias() -= basis_.leftCols(count_) * more;
    curve += more;
  }
  const double largest = largest_offset(left_);
  if (largest > options_.least) {
    grow(left_);
    curve.conservativeResize(count_);
    curve[count_ - 1] = left_.norm();
  } else {
    max_left_ = std::max(max_left_, largest);
    square_left_ += double(left_.squaredNorm());
  }
  if (normals.size() > 0) {
    if (turns_.rows() == 0) turns_ = MatrixXf::Zero(basis_.rows(), basis_.cols());
    if (turns_.rows() > 0) turns_.leftCols(count_).noalias() += normals * curve.transpose();
  }
  curves_.push_back(std::move(curve));
}

void MorphBasis::grow(const VectorXf& left) {
  if (count_ == basis_.cols()) {
    const Index capacity = std::max<Index>(kFirstCapacity, 2 * basis_.cols()), old = basis_.cols();
    basis_.conservativeResize(left.size(), capacity);
    if (turns_.rows() > 0) {
      turns_.conservativeResize(left.size(), capacity);
      turns_.rightCols(capacity - old).setZero();
    }
  }
  basis_.col(count_++) = left / left.norm();
}

MatrixXd MorphBasis::gathered() const {
  MatrixXd out = MatrixXd::Zero(Index(curves_.size()), count_);
  for (Index f = 0; f < out.rows(); ++f)
    out.row(f).head(curves_[f].size()) = curves_[f].transpose().cast<double>();
  return out;
}

void MorphBasis::condense() {
  const int kept = count_ / 2;
  const MatrixXd curves = gathered(), turn = falling_axes(curves);
  const MatrixXf turn_f = turn.cast<float>();
  MeshShapes all;
  all.shapes.noalias() = basis_.leftCols(count_) * turn_f;
  all.curves = (curves * turn).cast<float>();
  const DroppedShapes dropped = measure_dropped(all, kept);
  max_left_ += dropped.max_error;
  square_left_ += dropped.square_error;
  basis_.leftCols(kept) = all.shapes.leftCols(kept);
  if (turns_.rows() > 0) {
    turns_.leftCols(kept) = (turns_.leftCols(count_) * turn_f.leftCols(kept)).eval();
    turns_.rightCols(turns_.cols() - kept).setZero();
  }
  count_ = kept;
  for (Index f = 0; f < curves.rows(); ++f) curves_[f] = all.curves.row(f).head(kept).transpose();
}

MeshShapes MorphBasis::finish() {
  MeshShapes out;
  if (count_ == 0) basis_.resize(left_.size(), 0);
  const MatrixXd curves = gathered();
  const MatrixXd turn = falling_axes(curves);
  const MatrixXf turn_f = turn.cast<float>();
  const MatrixXd turned = curves * turn;
  out.shapes.noalias() = basis_.leftCols(count_) * turn_f;
  out.curves = turned.cast<float>();
  const DroppedShapes dropped = drop_shapes(out, options_);
  if (turns_.rows() > 0) {
    // Least squares: the turned curves are orthogonal.
    out.normals.noalias() = turns_.leftCols(count_) * turn_f.leftCols(dropped.kept);
    for (int m = 0; m < dropped.kept; ++m)
      out.normals.col(m) /= std::max(1e-12f, float(turned.col(m).squaredNorm()));
  }
  scale_curves(out);
  const double places = double(left_.size() / 3) * double(std::max<std::size_t>(1, curves_.size()));
  out.max_error = dropped.max_error + max_left_;
  out.rms_error = std::sqrt((dropped.square_error + square_left_) / places);
  *this = MorphBasis(left_.size() / 3, options_);
  return out;
}

}  // namespace ecorche::inline v1
