#include "skinning/bake/bake_normals.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/eigenvectors.h"

namespace ecorche::inline v1 {
namespace {

using Eigen::Index;

// The inverse, or that of the nearest rotation where the blend is nearly singular.
Mat3 back_to_rest(const Mat3& A) {
  if (A.determinant() > 0.2) return A.inverse();
  const Svd3 parts = svd(A);
  return parts.V * parts.U.transpose();
}

}  // namespace

std::vector<Points> fit_normals(const BakeScene& scene, Influences influences,
                                const std::vector<BakeFrame>& samples,
                                const Eigen::MatrixXd& curves) {
  constexpr double kRidge = 1e-4;  // regularisation of a change, a frame
  const Index count = curves.cols();
  std::vector<Points> out(curves.rows(), Points::Zero(scene.skin.V.rows(), 3));
  if (out.empty()) return out;
  Eigen::MatrixXd gram = curves * curves.transpose();
  gram.diagonal().array() += kRidge * double(count);
  const Eigen::MatrixXd projector = solve_ldlt_columns(gram, curves);  // #shapes x #samples
  tbb::parallel_for(Index{0}, scene.skin.V.rows(), [&](Index i) {
    Eigen::MatrixXd off(count, 3);
    for (Index f = 0; f < count; ++f) {
      const BakeFrame& frame = samples[f];
      const Mat3 back = back_to_rest(blended(influences[i], frame.bones).linear());
      off.row(f) =
          (back * frame.normals.row(i).transpose().cast<double>()).normalized().transpose() -
          scene.normals.row(i);
    }
    const Eigen::MatrixXd changes = projector * off;
    for (std::size_t m = 0; m < out.size(); ++m)
      if (const auto change = changes.row(Index(m)); change.norm() >= scene.options.least_turn)
        out[m].row(i) = change.cast<float>().cast<double>();
  });
  return out;
}

double angle_off(const std::array<Influence, 4>& influences, std::span<const Transform> bones,
                 const Vec3& shaped, const Vec3& exact) {
  const Vec3 played = blended(influences, bones).linear() * shaped;
  return std::atan2(played.cross(exact).norm(), played.dot(exact)) * 180 / std::numbers::pi;
}

}  // namespace ecorche::inline v1
