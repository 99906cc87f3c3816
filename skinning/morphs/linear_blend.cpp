#include "skinning/morphs/linear_blend.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/LU>

namespace ecorche::inline v1 {
namespace {

// Of the squares of a blend's stretches, which are 1 where it is rigid. Larger: vertices by joints
// that are twisted against each other stay away from their places; smaller: their offsets grow
// beyond all measure.
constexpr double kCollapse = 3e-4;

Affine blend_of(const JointWeights& influences, std::span<const Affine> moves) {
  Affine out;
  out.matrix().setZero();
  for (const Influence& influence : influences)
    if (influence.weight > 0)
      out.matrix() += influence.weight * moves[std::size_t(influence.joint)].matrix();
  return out;
}

Mat3 back_to_rest(const Mat3& A) {
  return (A.transpose() * A + kCollapse * Mat3::Identity()).inverse() * A.transpose() *
         (1 + kCollapse);
}

Vec3 at(std::span<const float> values, std::size_t i, int stride) {
  const float* p = &values[i * std::size_t(stride)];
  return Vec3(double(p[0]), double(p[1]), double(p[2]));
}

// act(vertex, blend, back): back is the inverse of the blend's linear part.
template <class Act>
void each_blend(const BlendedMesh& mesh, std::span<const Affine> moves, const Act& act) {
  Affine blend;
  Mat3 back;
  for (std::size_t i = 0; i < mesh.influences.size(); ++i) {
    const JointWeights& own = mesh.influences[i];
    bool same = i > 0;  // a section's vertices have the same
    for (int k = 0; k < 4 && same; ++k)
      same = own[k].joint == mesh.influences[i - 1][k].joint &&
             own[k].weight == mesh.influences[i - 1][k].weight;
    if (!same) {
      blend = blend_of(own, moves);
      back = back_to_rest(blend.linear());
    }
    act(i, blend, back);
  }
}

void require_rows(const BlendedMesh& mesh, std::span<const float> rows, int stride) {
  if (rows.size() != mesh.influences.size() * std::size_t(stride))
    throw std::invalid_argument("offsets_at_rest: positions of another mesh");
}

}  // namespace

JointWeights scaled_weights(JointWeights weights) {
  double sum = 0;
  for (const Influence& influence : weights) sum += influence.weight;
  for (Influence& influence : weights) influence.weight /= sum;
  return weights;
}

void find_joint_moves(std::span<const Transform> X_WJ, std::span<const Vec3> joint_rest,
                      std::vector<Affine>& out) {
  out.resize(X_WJ.size());
  for (std::size_t j = 0; j < X_WJ.size(); ++j)
    out[j] = Affine(X_WJ[j] * Eigen::Translation3d(-joint_rest[j]));
}

Vec3 blend_vertex(const BlendedMesh& mesh, std::span<const Affine> moves, std::size_t vertex,
                  const Vec3& offset) {
  return blend_of(mesh.influences[vertex], moves) * (at(mesh.positions, vertex, 3) + offset);
}

double offsets_at_rest(const BlendedMesh& mesh, std::span<const Affine> moves,
                       std::span<const float> positions, int stride, Eigen::VectorXf& out) {
  require_rows(mesh, positions, stride);
  out.resize(3 * Eigen::Index(mesh.influences.size()));
  double square = 0;
  each_blend(mesh, moves, [&](std::size_t i, const Affine& blend, const Mat3& back) {
    const Vec3 off = at(positions, i, stride) - blend * at(mesh.positions, i, 3), rest = back * off;
    square = std::max(square, (blend.linear() * rest - off).squaredNorm());
    out.segment<3>(3 * Eigen::Index(i)) = rest.cast<float>();
  });
  return std::sqrt(square);
}

void turns_at_rest(const BlendedMesh& mesh, std::span<const Affine> moves,
                   std::span<const float> normals, int stride, Eigen::VectorXf& out) {
  require_rows(mesh, normals, stride);
  out.resize(3 * Eigen::Index(mesh.influences.size()));
  each_blend(mesh, moves, [&](std::size_t i, const Affine&, const Mat3& back) {
    const Vec3 there = (back * at(normals, i, stride)).normalized();
    out.segment<3>(3 * Eigen::Index(i)) = (there - at(mesh.normals, i, 3)).cast<float>();
  });
}

}  // namespace ecorche::inline v1
