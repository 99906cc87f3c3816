// Laws of bound skins, on a synthetic arm.
#include <gtest/gtest.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <random>

#include "anatomy/errors.h"
#include "anatomy/geometry/subdivide.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "skinning/bind/bind.h"
#include "skinning/evaluation/skin_quality.h"
#include "tests/skinning/arm.h"
#include "tests/skinning/compiled_arm.h"

namespace ecorche {
namespace {

using test::Arm;
using test::make_arm;

struct SkinBound {
  Arm arm;
  PosingTable table;
  CharacterModel model;
};

// Muscles do not lift the skin here; see under_skin_test.cpp.
SkinBound bind_arm(const Arm& arm, const BindOptions& options = {}) {
  return {arm, make_posing_table(arm.anatomy),
          test::compile_without_collision(arm.anatomy, arm.skin, {.bind = options})};
}

Pose bent_skin(const Anatomy& anatomy, double elbow) {
  Pose pose = rest_pose(anatomy.skeleton);
  pose.rotations[3] = Quat(Eigen::AngleAxisd(-elbow, Vec3::UnitX()));
  return pose;
}

SkinFrame deform(const SkinBound& bound, const Pose& pose, PosedAnatomy& posed) {
  pose_anatomy(bound.table, bound.arm.anatomy.skeleton, pose, posed);
  return test::skin_over(bound.model, posed);
}

SkinFrame deform(const SkinBound& bound, const Pose& pose) {
  PosedAnatomy posed;
  return deform(bound, pose, posed);
}

TEST(Skin, RestPoseGivesTheInputBack) {
  const SkinBound bound = bind_arm(make_arm());
  Points V;
  to_points(deform(bound, rest_pose(bound.arm.anatomy.skeleton)), V);
  EXPECT_LT((V - bound.arm.skin.V).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Skin, FollowsRigidMotionExactly) {
  const SkinBound bound = bind_arm(make_arm());
  Pose pose = rest_pose(bound.arm.anatomy.skeleton);
  const Quat turn(Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()));
  const Vec3 root = pose.root, moved(0.7, 1.2, -0.4);
  pose.root = moved;
  pose.rotations[0] = turn;
  Points V;
  to_points(deform(bound, pose), V);
  double worst = 0;
  for (Eigen::Index i = 0; i < V.rows(); ++i)
    worst = std::max(
        worst, (turn * (Vec3(bound.arm.skin.V.row(i)) - root) + moved - Vec3(V.row(i))).norm());
  EXPECT_LT(worst, 1e-6);
}

TEST(Skin, MirroredInputGivesMirroredSkin) {
  const SkinBound left = bind_arm(make_arm(1)),
                  right = bind_arm([] {
                    Arm arm = make_arm(-1);
                    // the same vertices in the same order, reflected
                    const Arm other = make_arm(1);
                    arm.skin = other.skin;
                    arm.skin.V.col(0) *= -1;
                    arm.skin.F.col(1).swap(arm.skin.F.col(2));
                    for (std::size_t b = 0; b < arm.anatomy.bones.size(); ++b) {
                      arm.anatomy.bones[b].mesh = other.anatomy.bones[b].mesh;
                      arm.anatomy.bones[b].mesh.V.col(0) *= -1;
                      arm.anatomy.bones[b].mesh.F.col(1).swap(arm.anatomy.bones[b].mesh.F.col(2));
                    }
                    return arm;
                  }());
  Points L, R;
  to_points(deform(left, bent_skin(left.arm.anatomy, 1.8)), L);
  to_points(deform(right, bent_skin(right.arm.anatomy, 1.8)), R);
  R.col(0) *= -1;
  EXPECT_LT((L - R).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(Skin, EndsOfTheArmAreCarriedByTheirBones) {
  const SkinBound bound = bind_arm(make_arm(1, false));
  PosedAnatomy posed;
  Points V;
  to_points(deform(bound, bent_skin(bound.arm.anatomy, 2.0), posed), V);
  const std::vector<Vec3> origins = rest_positions(bound.arm.anatomy.skeleton);
  int upper = 0, lower = 0;
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const Vec3 X = bound.arm.skin.V.row(i);
    const int joint = X.y() > origins[3].y() + 0.18 ? 2 : X.y() < origins[3].y() - 0.18 ? 3 : -1;
    if (joint < 0) continue;
    (joint == 2 ? upper : lower)++;
    const Vec3 carried = posed.X_WJ[joint] * (X - origins[joint]);
    EXPECT_LT((carried - Vec3(V.row(i))).norm(), 2e-3);
  }
  EXPECT_GT(upper, 100);
  EXPECT_GT(lower, 100);
}

TEST(Skin, BentElbowDoesNotFoldAndKeepsItsVolume) {
  const SkinBound bound = bind_arm(make_arm(1, false));
  const std::vector<LimbSection> sections =
      limb_sections(bound.arm.anatomy.skeleton, bound.arm.skin, bound.model.binding.joint_weights);
  ASSERT_EQ(sections.size(), 1u);
  PosedAnatomy posed;
  const SkinFrame frame =
      deform(bound, bent_skin(bound.arm.anatomy, 2 * std::numbers::pi / 3), posed);
  const SkinQuality quality =
      measure_skin(bound.arm.skin, *bound.model.skin.blend, sections, posed.X_WJ, frame);
  EXPECT_EQ(quality.not_finite, 0);
  EXPECT_LE(quality.flipped_share, 0.001);
  EXPECT_GT(quality.limb_volume_change[0], -0.04);
  EXPECT_LT(quality.limb_volume_change[0], 0.04);
}

TEST(Skin, GoesDownWithTheMuscleAsItGoesUp) {
  const SkinBound bound = bind_arm(make_arm());
  PosedAnatomy posed;
  const Points rest = bound.arm.skin.V;
  std::array<Points, 2> moved;
  for (std::size_t k = 0; k < 2; ++k) {
    pose_anatomy(bound.table, bound.arm.anatomy.skeleton, rest_pose(bound.arm.anatomy.skeleton),
                 posed);
    for (Ellipse& slice : posed.slices) slice.radii *= k == 0 ? 1.1 : 0.9;
    to_points(test::skin_over(bound.model, posed), moved[k]);
    moved[k] -= rest;
  }
  const double most = moved[0].rowwise().norm().maxCoeff();
  EXPECT_GT(most, 5e-4);  // of the 1.8 mm by which the thickest section grows
  EXPECT_LT((moved[0] + moved[1]).rowwise().norm().maxCoeff(), 0.2 * most);
}

TEST(Skin, AnchorsAreTheNearestComponents) {
  const SkinBound bound = bind_arm(make_arm());
  PosedAnatomy rest;
  pose_anatomy(bound.table, bound.arm.anatomy.skeleton, rest_pose(bound.arm.anatomy.skeleton),
               rest);
  for (std::size_t i = 0; i < bound.model.binding.anchors.size(); i += 7) {
    const Anchor& anchor = bound.model.binding.anchors[i];
    const Vec3 p = bound.arm.skin.V.row(i);
    EXPECT_NEAR((p - anchor.point).norm(), anchor.distance, 1e-9);
    for (const Bone& bone : bound.arm.anatomy.bones) {  // no bone vertex may be nearer
      for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v)
        EXPECT_GE((p - Vec3(bone.mesh.V.row(v))).norm(), anchor.distance - 1e-9);
    }
    if (anchor.kind == Anchor::Kind::muscle) {
      EXPECT_LT((anchor.point - rest.slices[anchor.part].center).norm(), 0.05);
    }
  }
}

TEST(Skin, WhatIsOnlyWrittenHasTheSameAnchorsAndWeights) {
  const Arm arm = make_arm();
  const SkinBound bound = bind_arm(arm);
  const Skeleton& skeleton = arm.anatomy.skeleton;
  PosedAnatomy rest;
  ContactWorkspace contact;
  pose_muscles(bound.model.muscles, skeleton, rest_pose(skeleton), rest, contact);
  const Binding &moving = bound.model.binding, still = bind_for_export(arm.anatomy, rest, arm.skin);
  ASSERT_EQ(still.joint_weights.size(), moving.joint_weights.size());
  for (std::size_t v = 0; v < moving.joint_weights.size(); ++v) {
    EXPECT_EQ(still.anchors[v].part, moving.anchors[v].part);
    EXPECT_EQ(still.anchors[v].distance, moving.anchors[v].distance);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(still.joint_weights[v][k].joint, moving.joint_weights[v][k].joint);
      EXPECT_EQ(still.joint_weights[v][k].weight, moving.joint_weights[v][k].weight);
    }
  }
}

TEST(Skin, SameBytesAtOneAndTwoThreads) {
  const auto run = [](std::size_t threads) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const SkinBound bound = bind_arm(make_arm());
    return deform(bound, bent_skin(bound.arm.anatomy, 1.5));
  };
  const SkinFrame one = run(1), two = run(2);
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.normals, two.normals);
}

TEST(Skin, OrderOfVerticesDoesNotMatter) {
  Arm arm = make_arm(1, false), shuffled = arm;  // muscle handles are chosen in vertex order
  std::vector<int> order(arm.skin.V.rows());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = int(i);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  for (std::size_t i = 0; i < order.size(); ++i) shuffled.skin.V.row(order[i]) = arm.skin.V.row(i);
  for (Eigen::Index e = 0; e < arm.skin.F.size(); ++e)
    shuffled.skin.F.data()[e] = order[arm.skin.F.data()[e]];
  const SkinBound a = bind_arm(arm), b = bind_arm(shuffled);
  Points A, B;
  to_points(deform(a, bent_skin(arm.anatomy, 1.5)), A);
  to_points(deform(b, bent_skin(arm.anatomy, 1.5)), B);
  for (std::size_t i = 0; i < order.size(); ++i)
    EXPECT_LT((A.row(i) - B.row(order[i])).norm(), 2e-6);
}

TEST(Skin, ARefinedSkinMovesAsItsBaseDoes) {
  const SkinBound coarse = bind_arm(make_arm());
  const TriMesh& base = coarse.arm.skin;
  const Refinement refinement = refine(base.F, int(base.V.rows()));
  const TriMesh fine{refine_points(refinement, base.V), refinement.F};
  PosedAnatomy posed;
  pose_anatomy(coarse.table, coarse.arm.anatomy.skeleton, rest_pose(coarse.arm.anatomy.skeleton),
               posed);
  const BaseSkin from{base, refinement};
  const CharacterModel model =
      test::compile_without_collision(coarse.arm.anatomy, fine, {.base = &from});
  const Binding& binding = model.binding;
  const Binding alone = bind_skin(coarse.arm.anatomy, posed, fine).binding,
                written = bind_for_export(coarse.arm.anatomy, posed, base, refinement, fine);
  ASSERT_EQ(binding.anchors.size(), alone.anchors.size());
  ASSERT_EQ(binding.anchors.size(), written.anchors.size());
  for (std::size_t i = 0; i < binding.anchors.size(); ++i) {
    EXPECT_EQ(binding.anchors[i].part, alone.anchors[i].part);
    EXPECT_EQ(binding.anchors[i].distance, alone.anchors[i].distance);
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_EQ(binding.joint_weights[i][k].weight, written.joint_weights[i][k].weight);
  }
  Points V, coarse_V;
  to_points(test::skin_over(model, posed), V);
  EXPECT_LT((V - fine.V).cwiseAbs().maxCoeff(), 3e-6);
  to_points(deform(coarse, bent_skin(coarse.arm.anatomy, 1.5), posed), coarse_V);
  to_points(test::skin_over(model, posed), V);
  EXPECT_LT((V - refine_points(refinement, coarse_V)).rowwise().norm().maxCoeff(), 5e-6);
}

TEST(Skin, RefusesWhatItCannotBind) {
  Arm arm = make_arm(1, false);
  TriMesh skin;
  EXPECT_THROW(test::compile_figure(arm.anatomy, skin), UnfitError);
  skin = arm.skin;
  skin.V(5, 1) = std::nan("");
  EXPECT_THROW(test::compile_figure(arm.anatomy, skin), UnfitError);
  skin = arm.skin;
  arm.anatomy.bones.clear();
  EXPECT_THROW(test::compile_figure(arm.anatomy, skin), UnfitError);
}

TEST(Skin, RefusesAPoseOfAnotherAnatomy) {
  const SkinBound bound = bind_arm(make_arm());
  PosedAnatomy posed;
  posed.X_WJ.resize(2);
  EXPECT_THROW(test::skin_over(bound.model, posed), std::invalid_argument);
}

}  // namespace
}  // namespace ecorche
