#include "skinning/morphs/turned_curves.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "anatomy/compute/eigenvectors.h"

namespace ecorche::inline v1 {

using Eigen::Index;

namespace {

constexpr Index kBlock = 32;  // frames that are looked at together

}  // namespace

Eigen::MatrixXd falling_axes(const Eigen::MatrixXd& curves) {
  if (curves.cols() == 0) return {};
  const Eigen::MatrixXd gram = curves.transpose() * curves;
  return symmetric_eigen<Eigen::Dynamic>(gram).vectors.rowwise().reverse();
}

DroppedShapes measure_dropped(const MeshShapes& shapes, int kept) {
  const Index dropped = shapes.shapes.cols() - kept;
  DroppedShapes out{kept};
  for (Index f = 0; f < shapes.curves.rows() && dropped > 0; ++f) {
    const Eigen::VectorXf off =
        shapes.shapes.rightCols(dropped) * shapes.curves.row(f).tail(dropped).transpose();
    const Eigen::Map<const Eigen::Matrix3Xf> places(off.data(), 3, off.size() / 3);
    out.max_error =
        std::max(out.max_error, std::sqrt(double(places.colwise().squaredNorm().maxCoeff())));
    out.square_error += double(off.squaredNorm());
  }
  return out;
}

DroppedShapes drop_shapes(MeshShapes& shapes, const ShapeOptions& options) {
  const Index count = shapes.shapes.cols(), frames = shapes.curves.rows(),
              vertices = shapes.shapes.rows() / 3;
  const float error = float(options.error * options.error),
              worst = float(options.worst * options.worst);
  const long long allowed = (long long)(options.share * double(frames) * double(vertices));
  // By how many are kept, from all on down to where it goes too far.
  std::vector<float> largest(count + 1, 0);
  std::vector<double> squares(count + 1, 0);
  std::vector<long long> far(count + 1, 0);
  Index kept = 0;
  Eigen::MatrixXf off;
  for (Index begin = 0; begin < frames; begin += kBlock) {
    const Index size = std::min(kBlock, frames - begin);
    off.setZero(shapes.shapes.rows(), size);
    for (Index k = count; k-- > kept;) {
      off.noalias() += shapes.shapes.col(k) * shapes.curves.col(k).segment(begin, size).transpose();
      const Eigen::Map<const Eigen::Matrix3Xf> places(off.data(), 3, vertices * size);
      for (Index i = 0; i < places.cols(); ++i) {
        const float square = places.col(i).squaredNorm();
        largest[k] = std::max(largest[k], square);
        squares[k] += double(square);
        far[k] += square > error;
      }
      if ((largest[k] > worst || far[k] > allowed) && k < options.most) kept = k + 1;
    }
  }
  DroppedShapes out;
  out.kept = int(kept);
  out.max_error = std::sqrt(double(largest[kept]));
  out.square_error = squares[kept];
  shapes.shapes.conservativeResize(Eigen::NoChange, kept);
  shapes.curves.conservativeResize(Eigen::NoChange, kept);
  return out;
}

void scale_curves(MeshShapes& shapes) {
  const Index count = shapes.curves.cols(), frames = shapes.curves.rows();
  if (count == 0 || frames == 0) return;
  const bool has_normals = shapes.normals.cols() == count;
  const Eigen::VectorXf low = shapes.curves.colwise().minCoeff(),
                        range = shapes.curves.colwise().maxCoeff().transpose() - low;
  shapes.shapes.conservativeResize(Eigen::NoChange, count + 1);
  shapes.shapes.col(count).noalias() = shapes.shapes.leftCols(count) * low;
  if (has_normals) {
    shapes.normals.conservativeResize(Eigen::NoChange, count + 1);
    shapes.normals.col(count).noalias() = shapes.normals.leftCols(count) * low;
  }
  shapes.curves.conservativeResize(Eigen::NoChange, count + 1);
  shapes.curves.col(count).setOnes();
  for (Index m = 0; m < count; ++m) {
    if (range[m] == 0) {
      shapes.curves.col(m).setZero();
      continue;
    }
    shapes.curves.col(m) = (shapes.curves.col(m).array() - low[m]) / range[m];
    shapes.shapes.col(m) *= range[m];
    if (has_normals) shapes.normals.col(m) *= range[m];
  }
}

}  // namespace ecorche::inline v1
