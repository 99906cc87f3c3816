// Laws of the deformers that ours is compared with.
#include "skinning/evaluation/skin_methods.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"

#include <gtest/gtest.h>

#include <numbers>

#include "skinning/bind/bind.h"
#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

// A tube along -y from 0 to 1 m, radius 5 cm, its weights passing from bone 0 to bone 1 along all
// of its length.
struct SkinMethodsTube {
  TriMesh mesh;
  BlendSkin skin;
};

SkinMethodsTube make_tube() {
  std::vector<Vec2> profile;
  for (int k = 0; k <= 40; ++k) profile.emplace_back(k / 40.0, 0.05);
  SkinMethodsTube tube;
  tube.mesh = test::lathe(Vec3::Zero(), Vec3(0, -1, 0), profile, 24);
  std::vector<std::vector<BoneWeight>> weights;
  for (Eigen::Index i = 0; i < tube.mesh.V.rows(); ++i) {
    const double t = std::clamp(-tube.mesh.V(i, 1), 0.0, 1.0);
    weights.push_back({{0, 1 - t}, {1, t}});
  }
  tube.skin = make_blend_skin(tube.mesh, weights);
  return tube;
}

Vec3 place(const SkinFrame& frame, Eigen::Index i) {
  const std::size_t at = 4 * i;
  return {frame.positions[at], frame.positions[at + 1], frame.positions[at + 2]};
}

double largest_error_skin_methods(const SkinFrame& frame, const TriMesh& mesh, const Transform& X) {
  double worst = 0;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    worst = std::max(worst, (place(frame, i) - X * Vec3(mesh.V.row(i))).norm());
  return worst;
}

Transform some_motion() {
  Transform X = Transform::Identity();
  X.translate(Vec3(0.3, -0.2, 0.5)).rotate(Eigen::AngleAxisd(1.2, Vec3(1, 2, 3).normalized()));
  return X;
}

// Least distance from the tube's axis of the vertices in its middle half, its ends turned by
// `angle` against each other.
double waist(const SkinMethodsTube& tube, double angle, bool dual) {
  Transform turn = Transform::Identity();
  turn.rotate(Eigen::AngleAxisd(angle, Vec3::UnitY()));
  const std::vector<Transform> bones{Transform::Identity(), turn};
  SkinFrame frame;
  dual ? deform_dual_quaternion(tube.skin, bones, frame) : deform_linear(tube.skin, bones, frame);
  double least = 1;
  for (Eigen::Index i = 0; i < 41 * 24; ++i)
    if (std::abs(tube.mesh.V(i, 1) + 0.5) < 0.25)
      least = std::min(least, std::hypot(place(frame, i).x(), place(frame, i).z()));
  return least;
}

TEST(SkinMethods, NamesAreUnderstood) {
  for (const SkinMethod method : kSkinMethods) EXPECT_EQ(skin_method(short_name(method)), method);
  EXPECT_FALSE(skin_method("wrap"));
}

TEST(DualQuaternion, ATwistKeepsTheRadiusThatLinearBlendLoses) {
  const SkinMethodsTube tube = make_tube();
  for (const double degrees : {60.0, 120.0, 175.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    EXPECT_NEAR(waist(tube, angle, true), 0.05, 1e-6) << degrees;
    EXPECT_NEAR(waist(tube, angle, false), 0.05 * std::cos(angle / 2), 1e-4)
        << degrees;  // half way, where the mean of both ends lies
  }
}

TEST(DeltaMush, RestComesBackAndRigidMotionIsFollowed) {
  const SkinMethodsTube tube = make_tube();
  for (const Transform& X : {Transform::Identity(), some_motion()}) {
    SkinFrame frame;
    const std::vector<Transform> still(2, Transform::Identity()), bones{X, X};
    deform_linear(tube.skin, still, frame);
    const MushTables tables = make_mush(tube.mesh, frame.positions);
    deform_linear(tube.skin, bones, frame);
    MushWorkspace scratch;
    deform_mush(tables, scratch, frame);
    EXPECT_LT(largest_error_skin_methods(frame, tube.mesh, X), 1e-6);
  }
}

TEST(DeltaMush, SmoothsAStepButKeepsTheDetail) {
  SkinMethodsTube tube = make_tube();
  const Eigen::Index wart = 20 * 24 + 3;  // a vertex pulled out of the surface
  const Vec3 out = Vec3(tube.mesh.V(wart, 0), 0, tube.mesh.V(wart, 2)).normalized();
  tube.mesh.V.row(wart) += 0.004 * out.transpose();
  std::vector<std::vector<BoneWeight>>
      weights;  // all of one bone above the middle and all of the other below
  for (Eigen::Index i = 0; i < tube.mesh.V.rows(); ++i)
    weights.push_back({{tube.mesh.V(i, 1) > -0.51 ? 0 : 1, 1}});
  tube.skin = make_blend_skin(tube.mesh, weights);
  SkinFrame frame;
  const std::vector<Transform> still(2, Transform::Identity());
  deform_linear(tube.skin, still, frame);
  const MushTables tables = make_mush(tube.mesh, frame.positions);
  std::vector<Transform> bones = still;
  bones[1].translate(Vec3(0, 0, 0.02));  // a shear of 20 mm from one ring to the next
  deform_linear(tube.skin, bones, frame);
  const double sheared = (place(frame, 21 * 24) - place(frame, 20 * 24)).z();
  MushWorkspace scratch;
  deform_mush(tables, scratch, frame);
  EXPECT_NEAR(sheared, 0.02, 1e-6);
  EXPECT_LT((place(frame, 21 * 24) - place(frame, 20 * 24)).z(), 0.006);
  // both sides of the ring
  const Vec3 axis = (place(frame, 20 * 24) + place(frame, 20 * 24 + 12)) / 2;
  EXPECT_NEAR((place(frame, wart) - axis).norm() - 0.05, 0.004, 0.001);
}

struct SkinMethodsBoundArm {
  test::Arm arm = test::make_arm();
  PosingTable table = make_posing_table(arm.anatomy);
  PosedAnatomy rest, posed;
  Binding binding;
  NearestPartSkin skin;

  SkinMethodsBoundArm() {
    pose_anatomy(table, arm.anatomy.skeleton, rest_pose(arm.anatomy.skeleton), rest);
    binding = bind_skin(arm.anatomy, rest, arm.skin).binding;
    skin = make_nearest_part_skin(arm.anatomy, rest, arm.skin, binding);
  }
};

TEST(NearestPartSkin, RestComesBackAndRigidMotionIsFollowed) {
  SkinMethodsBoundArm arm;
  SkinFrame frame;
  deform_nearest_part(arm.skin, arm.rest, frame);
  EXPECT_LT(largest_error_skin_methods(frame, arm.arm.skin, Transform::Identity()), 1e-6);
  const Transform X = some_motion();
  Pose pose = rest_pose(arm.arm.anatomy.skeleton);
  pose.root = X * pose.root;
  pose.rotations[0] = Quat(X.linear());
  pose_anatomy(arm.table, arm.arm.anatomy.skeleton, pose, arm.posed);
  deform_nearest_part(arm.skin, arm.posed, frame);
  EXPECT_LT(largest_error_skin_methods(frame, arm.arm.skin, X), 1e-6);
}

TEST(NearestPartSkin, AVertexOverABoneStaysOnIt) {
  SkinMethodsBoundArm arm;
  const Skeleton& skeleton = arm.arm.anatomy.skeleton;
  Pose pose = rest_pose(skeleton);
  const int elbow = find_joint(skeleton, "elbow_l");
  ASSERT_GE(elbow, 0);
  pose.rotations[elbow] = Quat(Eigen::AngleAxisd(-1, Vec3::UnitX()));
  pose_anatomy(arm.table, skeleton, pose, arm.posed);
  SkinFrame frame;
  deform_nearest_part(arm.skin, arm.posed, frame);
  int on_bones = 0;
  for (Eigen::Index i = 0; i < arm.arm.skin.V.rows(); ++i) {
    const Anchor& anchor = arm.binding.anchors[i];
    if (anchor.kind != Anchor::Kind::bone) continue;
    const std::size_t j = arm.arm.anatomy.bones[anchor.part].joint;
    const Vec3 expected =
        arm.posed.X_WJ[j] * (Vec3(arm.arm.skin.V.row(i)) - arm.rest.X_WJ[j].translation());
    EXPECT_LT((place(frame, i) - expected).norm(), 1e-6);
    ++on_bones;
  }
  EXPECT_GT(on_bones, 10);
}

}  // namespace
}  // namespace ecorche
