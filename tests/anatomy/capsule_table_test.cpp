// Laws of the capsules' table: bad rows get exact errors; on the source skeleton every sleeve lies
// about its two bones, and right ones are the mirror images of left ones.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "anatomy/authoring/capsule_table.h"
#include "anatomy/bones/bone_package.h"
#include "anatomy/bones/mirror.h"
#include "anatomy/errors.h"
#include "tests/anatomy/source_skeleton.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

const std::string kHead =
    "capsule,paired,kind,label,group,near,far,axis_left,axis_up,axis_front,at_left,at_up,at_front,"
    "up_mm,down_mm,radius_mm,thickness_mm,source\n";

std::string error_of(const std::string& row) {
  try {
    read_capsule_text(kHead + row, "c.csv");
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(CapsuleTable, ReadsWhatItsHeadSays) {
  const auto rules = read_capsule_text(
      kHead +
          "knee,yes,capsule,capsule of the knee,leg,femur,tibia fibula,,,,,,,30,12,50,1.5,Gray\n",
      "c.csv");
  ASSERT_EQ(rules.size(), 1u);
  EXPECT_TRUE(rules[0].paired);
  EXPECT_FALSE(rules[0].disc);
  EXPECT_EQ(rules[0].far, (std::vector<std::string>{"tibia", "fibula"}));
  EXPECT_DOUBLE_EQ(rules[0].up, 0.03);
  EXPECT_DOUBLE_EQ(rules[0].thickness, 0.0015);
  EXPECT_TRUE(rules[0].axis.isZero());
  EXPECT_FALSE(rules[0].at);
}

TEST(CapsuleTable, BadRowsAreNamed) {
  EXPECT_EQ(error_of("knee,maybe,capsule,k,leg,femur,tibia,,,,,,,30,12,50,1,\n"),
            "c.csv:2: knee: paired: 'maybe'; expected yes or no");
  EXPECT_EQ(error_of("knee,yes,bag,k,leg,femur,tibia,,,,,,,30,12,50,1,\n"),
            "c.csv:2: knee: kind: 'bag'; expected capsule or disc");
  EXPECT_EQ(error_of("knee,yes,capsule,k,leg,,tibia,,,,,,,30,12,50,1,\n"),
            "c.csv:2: knee: a bone is missing in near or far");
  EXPECT_EQ(error_of("knee,yes,capsule,k,leg,femur,tibia,,,,,,,30,-30,50,1,\n"),
            "c.csv:2: knee: up_mm and down_mm leave no room between");
  EXPECT_EQ(error_of("knee,yes,capsule,k,leg,femur,tibia,,,,,,,30,12,500,1,\n"),
            "c.csv:2: knee: radius_mm: 500 is not within 2 .. 100");
  EXPECT_EQ(error_of("knee,yes,capsule,k,leg,femur,tibia,,,,,,,30,12,50,1,\n"
                     "knee,yes,capsule,k,leg,femur,tibia,,,,,,,30,12,50,1,\n"),
            "c.csv:3: knee: it is given twice");
}

// Two balls, 40 mm wide, 4 mm apart on the vertical through x = 100 mm.
Anatomy two_balls() {
  Anatomy anatomy;
  for (const char* name : {"upper", "lower"}) {
    Joint joint;
    joint.name = std::string(name) + "_joint_l";
    joint.parent = int(anatomy.skeleton.joints.size()) - 1;
    anatomy.skeleton.joints.push_back(joint);
    Bone bone;
    bone.name = std::string(name) + "_l";
    bone.side = Side::left;
    bone.joint = int(anatomy.bones.size());
    const double up = bone.joint == 0 ? 1.022 : 0.978;
    bone.mesh.V.resize(2000, 3);
    for (int i = 0; i < 2000; ++i) {
      const double z = 1 - (2 * i + 1) / 2000.0, turn = 2.399963 * i, r = std::sqrt(1 - z * z);
      bone.mesh.V.row(i) << 0.1 + 0.02 * r * std::cos(turn), up + 0.02 * z,
          0.02 * r * std::sin(turn);
    }
    anatomy.bones.push_back(bone);
  }
  return anatomy;
}

TEST(CapsuleTable, ASleeveLiesBetweenTheFacesOfItsBones) {
  const auto rules = read_capsule_text(
      kHead + "ball,yes,capsule,a ball,leg,upper,lower,,,,,,,10,10,30,1,\n", "c.csv");
  const auto plans = place_capsules(rules, two_balls());
  ASSERT_EQ(plans.size(), 2u);
  EXPECT_EQ(plans[0].bones, (std::vector<std::string>{"upper_l", "lower_l"}));
  EXPECT_EQ(plans[0].near, 1);
  Vec3 middle = Vec3::Zero();
  for (const PathPoint& point : plans[0].points) middle += point.rest / plans[0].points.size();
  EXPECT_LT((middle - Vec3(0.1, 1, 0)).norm(), 1e-3);
  for (const PathPoint& point : plans[0].points) {
    EXPECT_LT(std::abs(point.rest.y() - 1), 0.0105);
    EXPECT_NEAR((point.rest - Vec3(0.1, point.rest.y(), 0)).norm(), 0.03, 1e-3);
  }
  EXPECT_EQ(plans[0].points.front().joints[0], 0);
  EXPECT_EQ(plans[0].points.back().joints[0], 1);
  Anatomy lone = two_balls();
  lone.bones.pop_back();
  EXPECT_THROW(place_capsules(rules, lone), InputError);
  const auto far_up = read_capsule_text(
      kHead + "ball,yes,capsule,a ball,leg,upper,lower,,,,,,,90,10,30,1,\n", "c.csv");
  EXPECT_THROW(place_capsules(far_up, two_balls()), InputError);
}

TEST(CapsuleTable, RightIsTheMirrorImageOfLeft) {
  NEED_SOURCE_SKELETON(source);
  const auto plans = place_capsules(read_capsule_rules(test_assets().tables), source);
  ASSERT_GE(plans.size(), 100u);
  for (std::size_t n = 0; n + 1 < plans.size(); ++n) {
    if (plans[n].side != Side::left) continue;
    const FasciaPlan &left = plans[n], &right = plans[n + 1];
    EXPECT_EQ(mirror_name(left.name), right.name);
    for (int r = 0; r < left.rows; ++r)
      for (int c = 0; c < left.columns; ++c) {
        const int other = (left.columns - c) % left.columns;
        const PathPoint &a = left.points[std::size_t(r * left.columns + c)],
                        &b = right.points[std::size_t(r * left.columns + other)];
        EXPECT_LT((mirror_point(a.rest) - b.rest).norm(), 1e-12);
        EXPECT_EQ(mirror_name(source.skeleton.joints[std::size_t(a.joints[0])].name),
                  source.skeleton.joints[std::size_t(b.joints[0])].name);
      }
  }
}

}  // namespace
}  // namespace ecorche
