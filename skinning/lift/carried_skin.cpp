#include "skinning/lift/carried_skin.h"

#include <algorithm>

namespace ecorche::inline v1 {
namespace {

using Blend = Eigen::Matrix<double, 3, 4>;

// X_WJ(pose) X_WJ(rest)^-1 of every joint.
std::vector<Blend> turns_from_rest(const Skeleton& skeleton, const std::vector<Transform>& X_WJ) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  std::vector<Blend> out(X_WJ.size());
  for (std::size_t j = 0; j < X_WJ.size(); ++j) {
    const Mat3 R = X_WJ[j].linear();
    out[j] << R, X_WJ[j].translation() - R * rest[j];
  }
  return out;
}

Blend blend_of(const std::vector<Blend>& turns, const JointWeights& weights) {
  Blend out = Blend::Zero();
  for (const Influence& each : weights)
    if (each.weight > 0) out += each.weight * turns[std::size_t(each.joint)];
  return out;
}

}  // namespace

void carried_skin(const Patient& patient, const std::vector<Transform>& X_WJ, const Points& shape,
                  Points& out) {
  const std::vector<Blend> turns = turns_from_rest(patient.skeleton, X_WJ);
  out.resize(patient.skin.V.rows(), 3);
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const Blend B = blend_of(turns, patient.weights[std::size_t(i)]);
    Vec3 place = patient.skin.V.row(i).transpose();
    if (shape.rows() > 0) place += shape.row(i).transpose();
    out.row(i) = (B.leftCols<3>() * place + B.col(3)).transpose();
  }
}

void carried_skin(const Patient& patient, const Pose& pose, const Points& shape, Points& out) {
  std::vector<Transform> X_WJ;
  forward_kinematics(patient.skeleton, pose, X_WJ);
  carried_skin(patient, X_WJ, shape, out);
}

void fit_shape(const Patient& patient, const std::vector<Transform>& X_WJ, const Points& shaped,
               Points& shape) {
  // A blend of opposed turns is nearly singular; there the shape stays within a few centimetres.
  constexpr double kSmallestDeterminant = 0.2, kMost = 0.06;
  const std::vector<Blend> turns = turns_from_rest(patient.skeleton, X_WJ);
  shape.resize(shaped.rows(), 3);
  for (Eigen::Index i = 0; i < shaped.rows(); ++i) {
    const Blend B = blend_of(turns, patient.weights[std::size_t(i)]);
    const Mat3 A = B.leftCols<3>();
    Vec3 offset = Vec3::Zero();
    if (A.determinant() > kSmallestDeterminant)
      offset =
          A.inverse() * (shaped.row(i).transpose() - B.col(3)) - patient.skin.V.row(i).transpose();
    shape.row(i) = (offset * std::min(1.0, kMost / std::max(offset.norm(), 1e-9))).transpose();
  }
}

}  // namespace ecorche::inline v1
