#include <gtest/gtest.h>

#include "plain_skeleton.h"
#include "skinning/bind/blend_frames.h"
#include "skinning/bind/weight_rules.h"

using namespace ecorche;

// What a joint above the shoulder holds of the arm's skin moves it along the arm and not across.
TEST(SlideFrames, DrawTheSkinAlongTheArmAlone) {
  const Skeleton skeleton = plain_skeleton();
  FrameTables tables;
  tables.origins = rest_positions(skeleton);
  for (const Joint& joint : skeleton.joints) {
    tables.parents.push_back(joint.parent);
    tables.long_axes.push_back(joint.axes.col(2));
  }
  const int thorax = find_joint(skeleton, "thorax"), shoulder = find_joint(skeleton, "shoulder_l"),
            elbow = find_joint(skeleton, "elbow_l");
  const Vec3 from = tables.origins[std::size_t(shoulder)], to = tables.origins[std::size_t(elbow)];
  const Vec3 axis = (to - from).normalized(), middle = 0.5 * (from + to) + Vec3(0, 0, 0.04);
  TriMesh skin{Points(1, 3), Triangles(0, 3)};
  skin.V.row(0) = middle;
  std::vector<WeightRow> rows = {{{thorax, 0.15}, {shoulder, 0.85}}};
  let_arm_skin_slide(skeleton, skin, tables, rows);
  ASSERT_EQ(tables.slides.size(), 1u);
  EXPECT_EQ(tables.joint_of(tables.first_slide()), thorax);

  Pose pose = rest_pose(skeleton);
  pose.rotations[std::size_t(shoulder)] = Quat(Eigen::AngleAxisd(1.2, Vec3::UnitX()));
  std::vector<Transform> X_WJ;
  forward_kinematics(skeleton, pose, X_WJ);
  FrameWorkspace frames;
  pose_blend_frames(tables, X_WJ, frames);
  const auto place = [&](const WeightRow& row) {
    Vec3 out = Vec3::Zero();
    for (const Influence& w : row)
      out += w.weight * (frames.joints[std::size_t(w.joint)] * (middle - tables.origins[0]));
    return out;
  };
  const Vec3 alone = place({{shoulder, 1.0}}), both = place({{thorax, 0.15}, {shoulder, 0.85}}),
             slid = place(rows[0]);
  const Vec3 along = X_WJ[std::size_t(shoulder)].linear() * axis;
  EXPECT_NEAR((slid - alone).cross(along).norm(), 0, 1e-9);
  EXPECT_NEAR((slid - both).dot(along), 0, 1e-9);
  EXPECT_GT((both - alone).cross(along).norm(), 0.01);
}

// The web before and behind the armpit, of which the arm holds little, stays with the trunk.
TEST(SlideFrames, LeaveTheArmpitsWebAlone) {
  const Skeleton skeleton = plain_skeleton();
  FrameTables tables;
  tables.origins = rest_positions(skeleton);
  const int thorax = find_joint(skeleton, "thorax"), shoulder = find_joint(skeleton, "shoulder_l"),
            elbow = find_joint(skeleton, "elbow_l");
  TriMesh skin{Points(1, 3), Triangles(0, 3)};
  skin.V.row(0) =
      0.5 * (tables.origins[std::size_t(shoulder)] + tables.origins[std::size_t(elbow)]);
  std::vector<WeightRow> rows = {{{thorax, 0.72}, {shoulder, 0.28}}};
  let_arm_skin_slide(skeleton, skin, tables, rows);
  EXPECT_TRUE(tables.slides.empty());
  EXPECT_EQ(rows[0].size(), 2u);
}

// In people a raised arm narrows its root: half-way frames count less there than at a hip.
TEST(FramePairs, CountLessAboutTheGirdle) {
  const Skeleton skeleton = plain_skeleton();
  FrameTables tables;
  tables.origins = rest_positions(skeleton);
  const std::vector<Vec3>& origins = tables.origins;
  const auto weight_between = [&](const char* upper, const char* lower) {
    const int a = find_joint(skeleton, upper), b = find_joint(skeleton, lower);
    TriMesh skin{Points(1, 3), Triangles(0, 3)};
    skin.V.row(0) = origins[std::size_t(b)] + Vec3(0, 0, 0.05);
    std::vector<WeightRow> rows = {{{a, 0.5}, {b, 0.5}}};
    const std::vector<FramePair> pairs = add_frame_pairs(skeleton, skin, tables, rows);
    EXPECT_EQ(pairs.size(), 1u) << lower;
    return rows[0].back().weight;
  };
  EXPECT_NEAR(weight_between("pelvis", "hip_l"), 0.5, 1e-9);
  EXPECT_NEAR(weight_between("shoulder_r", "elbow_r"), 0.5, 1e-9);
  EXPECT_LT(weight_between("scapula_l", "shoulder_l"), 0.25);
  EXPECT_LT(weight_between("thorax", "clavicle_r"), 0.25);
}
