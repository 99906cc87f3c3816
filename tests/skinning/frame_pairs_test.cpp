#include <gtest/gtest.h>

#include <array>

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

// Vertices before and behind the thigh at these fractions of its length, held by hip and trunk.
struct ThighSkin {
  Skeleton skeleton = plain_skeleton();
  FrameTables tables;
  TriMesh skin{Points(4, 3), Triangles(0, 3)};
  std::vector<WeightRow> rows;
  int pelvis = find_joint(skeleton, "pelvis"), hip = find_joint(skeleton, "hip_l"),
      knee = find_joint(skeleton, "knee_l");

  ThighSkin(double upper, double lower, double of_trunk) {
    tables.origins = rest_positions(skeleton);
    for (const Joint& joint : skeleton.joints) {
      tables.parents.push_back(joint.parent);
      tables.long_axes.push_back(joint.axes.col(2));
    }
    const Vec3 from = tables.origins[std::size_t(hip)], to = tables.origins[std::size_t(knee)];
    for (int v = 0; v < 4; ++v)
      skin.V.row(v) =
          from + (v < 2 ? upper : lower) * (to - from) + Vec3(0, 0, v % 2 == 0 ? 0.07 : -0.07);
    rows.assign(4, {{hip, 1 - of_trunk}, {pelvis, of_trunk}});
  }

  double weight(int vertex, int frame) const {
    double out = 0;
    for (const Influence& w : rows[std::size_t(vertex)])
      if (w.joint == frame) out += w.weight;
    return out;
  }
};

// A bent knee draws the thigh's skin along the femur and not across, more in front than behind and
// more near the knee; weights of joints stay.
TEST(SlideFrames, DrawTheThighsSkinToTheKnee) {
  ThighSkin thigh(0.4, 0.8, 0);
  let_thigh_skin_slide(thigh.skeleton, thigh.skin, thigh.tables, thigh.rows);
  ASSERT_EQ(thigh.tables.slides.size(), 2u);
  EXPECT_EQ(thigh.tables.joint_of(thigh.tables.first_slide()), thigh.hip);
  Pose pose = rest_pose(thigh.skeleton);
  pose.rotations[std::size_t(thigh.knee)] =
      Quat(Eigen::AngleAxisd(2.0, thigh.skeleton.joints[std::size_t(thigh.knee)].axes.col(0)));
  std::vector<Transform> X_WJ;
  forward_kinematics(thigh.skeleton, pose, X_WJ);
  FrameWorkspace frames;
  pose_blend_frames(thigh.tables, X_WJ, frames);
  const Vec3 bone =
      (thigh.tables.origins[std::size_t(thigh.knee)] - thigh.tables.origins[std::size_t(thigh.hip)])
          .normalized();
  std::array<double, 4> drawn{};
  for (int v = 0; v < 4; ++v) {
    const Vec3 p = Vec3(thigh.skin.V.row(v)) - thigh.tables.origins[0];
    Vec3 moved = -p;
    for (const Influence& w : thigh.rows[std::size_t(v)])
      moved += w.weight * (frames.joints[std::size_t(w.joint)] * p);
    EXPECT_NEAR(moved.cross(bone).norm(), 0, 1e-9);
    drawn[std::size_t(v)] = moved.dot(bone);
  }
  EXPECT_GT(drawn[0], 0.01);
  EXPECT_GT(drawn[2], drawn[0]);
  EXPECT_LT(drawn[2], 0.08);
  EXPECT_LT(drawn[1], 0.5 * drawn[0]);
  EXPECT_LT(drawn[3], 0.5 * drawn[2]);
}

// At mid-thigh the trunk holds little of the skin, next to the groin what it held.
TEST(WeightRules, TheTrunkLetsGoOfTheThigh) {
  ThighSkin thigh(0.1, 0.6, 0.25);
  release_thigh(thigh.skeleton, thigh.skin, thigh.rows);
  EXPECT_EQ(thigh.weight(0, thigh.pelvis), 0.25);
  for (const int v : {2, 3}) {
    EXPECT_LT(thigh.weight(v, thigh.pelvis), 0.06);
    EXPECT_NEAR(thigh.weight(v, thigh.pelvis) + thigh.weight(v, thigh.hip), 1, 1e-12);
  }
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
