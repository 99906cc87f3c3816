#include "skinning/evaluation/blend_skinning.h"

#include <gtest/gtest.h>

#include "anatomy/geometry/vertex_normals.h"
#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

BlendSkin two_bone_skin(const TriMesh& mesh) {
  std::vector<std::vector<BoneWeight>> weights(mesh.V.rows());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double t = std::clamp((1.1 - mesh.V(i, 1)) / 0.1 + 0.5, 0.0, 1.0);
    weights[i] = {{0, 1 - t}, {1, t}};
  }
  return make_blend_skin(mesh, weights);
}

double largest_error(const SkinFrame& frame, const TriMesh& mesh, const Transform& X) {
  double worst = 0;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    for (int k = 0; k < 3; ++k)
      worst = std::max(worst, std::abs(frame.positions[4 * i + k] - (X * Vec3(mesh.V.row(i)))[k]));
  return worst;
}

TEST(Baseline, BothFollowARigidMotion) {
  const TriMesh mesh = test::make_arm().skin;
  const BlendSkin skin = two_bone_skin(mesh);
  Transform X = Transform::Identity();
  X.translate(Vec3(0.3, -0.2, 0.5)).rotate(Eigen::AngleAxisd(1.2, Vec3(1, 2, 3).normalized()));
  const std::vector<Transform> bones{X, X};
  SkinFrame frame;
  deform_linear(skin, bones, frame);
  EXPECT_LT(largest_error(frame, mesh, X), 1e-6);
  deform_dual_quaternion(skin, bones, frame);
  EXPECT_LT(largest_error(frame, mesh, X), 1e-6);
}

TEST(Baseline, HalfWayVertexIsTheMeanForLinearAndTheHalfTurnForDualQuaternions) {
  TriMesh mesh = test::make_arm().skin;
  std::vector<std::vector<BoneWeight>> weights(mesh.V.rows(), {{0, 0.5}, {1, 0.5}});
  const BlendSkin skin = make_blend_skin(mesh, weights);
  Transform turn = Transform::Identity();
  turn.linear() = Eigen::AngleAxisd(1.6, Vec3::UnitZ()).toRotationMatrix();
  Transform half = Transform::Identity();
  half.linear() = Eigen::AngleAxisd(0.8, Vec3::UnitZ()).toRotationMatrix();
  const std::vector<Transform> bones{Transform::Identity(), turn};
  SkinFrame frame;
  deform_linear(skin, bones, frame);
  const Vec3 X = mesh.V.row(40), mean = 0.5 * (X + turn * X);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(frame.positions[160 + k], mean[k], 1e-6);
  deform_dual_quaternion(skin, bones, frame);
  EXPECT_LT(largest_error(frame, mesh, half), 1e-6);
}

TEST(Baseline, RefusesMissingBones) {
  const BlendSkin skin = two_bone_skin(test::make_arm().skin);
  SkinFrame frame;
  EXPECT_THROW(deform_linear(skin, std::vector<Transform>(1, Transform::Identity()), frame),
               std::invalid_argument);
}

TEST(Normals, OfATubePointOutwards) {
  const TriMesh mesh = test::capsule(Vec3::Zero(), Vec3(0, 1, 0), 0.3, 48);
  std::vector<float> p(4 * mesh.V.rows(), 1.0f), n(p.size());
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    for (int k = 0; k < 3; ++k) p[4 * i + k] = float(mesh.V(i, k));
  vertex_normals(p, {mesh.F.data(), std::size_t(mesh.F.size())}, n);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const Vec3 normal(n[4 * i], n[4 * i + 1], n[4 * i + 2]);
    EXPECT_NEAR(normal.norm(), 1, 1e-5);
    if (mesh.V(i, 1) < 0.2 || mesh.V(i, 1) > 0.8) continue;
    EXPECT_GT(normal.dot(Vec3(mesh.V(i, 0), 0, mesh.V(i, 2)).normalized()), 0.99);
  }
}

}  // namespace
}  // namespace ecorche
