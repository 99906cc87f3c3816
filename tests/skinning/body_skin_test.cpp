// Skins of real bodies beside linear blend skinning with the body package's weights, on hard poses
// and over the long jump.
#include <gtest/gtest.h>

#include <numbers>
#include <optional>

#include "anatomy/errors.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "morph/fit/fit_anatomy.h"
#include "morph/shapes/standard_bodies.h"
#include "morph/template/template.h"
#include "morph/template/template_cache.h"
#include "skinning/bind/bind.h"
#include "skinning/checks/bulges.h"
#include "skinning/evaluation/package_blend.h"
#include "skinning/evaluation/pose_figures.h"
#include "skinning/evaluation/skin_quality.h"
#include "skinning/motion/pose_book.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"
#include "tests/body_fixture.h"
#include "tests/skinning/compiled_arm.h"
#include "tests/some_of.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {
// A fitted body with its skin bound, and the linear blend of the same skin.
struct Figure {
  Anatomy anatomy;
  TriMesh skin;
  PosingTable table;
  std::optional<CharacterModel> model;
  LinearBaseline baseline;
  std::vector<LimbSection> sections;
  PosedAnatomy posed;

  size_t joint(const char* name) const { return std::size_t(find_joint(anatomy.skeleton, name)); }

  SkinFrame play(const Pose& pose) {
    pose_anatomy(table, anatomy.skeleton, pose, posed);
    return test::skin_over(*model, posed);
  }
  // Of the pose that was played last.
  SkinFrame linear() const {
    SkinFrame frame;
    deform_linear_baseline(baseline, anatomy.skeleton, posed.X_WJ, frame);
    return frame;
  }
  SkinQuality quality(const SkinFrame& frame) const {
    return measure_skin(skin, *model->skin.blend, sections, posed.X_WJ, frame);
  }
};

class BodySkin : public BodyFixture {
 protected:
  void SetUp() override {
    BodyFixture::SetUp();
    if (IsSkipped() || template_) return;
    try {
      template_ = std::make_unique<Template>(read_template(test_assets()));
    } catch (const InputError& error) {
      GTEST_SKIP() << error.what();
    }
  }
  static Figure figure(const BodySpec& spec) {
    const Body body = make_body(package(), spec);
    Figure out;
    out.anatomy = fit_anatomy(*template_, body).anatomy;
    out.skin = body.skin;
    out.table = make_posing_table(out.anatomy);
    out.model = test::compile_without_collision(out.anatomy, body.skin);
    out.baseline = make_linear_baseline(package(), out.anatomy.skeleton, out.skin);
    out.sections = limb_sections(out.anatomy.skeleton, out.skin, out.model->binding.joint_weights);
    return out;
  }
  static BodySpec standard_body(const std::string& name) {
    for (const BodySpec& spec : standard_bodies())
      if (spec.name == name) return spec;
    throw std::invalid_argument(name);
  }

 private:
  static inline std::unique_ptr<Template> template_;
};

// The elbow or the knee bent so that its segments enclose 120 degrees.
Pose bent_pose(const Figure& figure, const char* upper, const char* middle, const char* lower) {
  const std::vector<Vec3> at = rest_positions(figure.anatomy.skeleton);
  const size_t j = figure.joint(middle);
  const Vec3 a = (at[j] - at[figure.joint(upper)]).normalized(),
             b = (at[figure.joint(lower)] - at[j]).normalized();
  Pose pose = rest_pose(figure.anatomy.skeleton);
  pose.rotations[j] = Quat(Eigen::AngleAxisd(120 * kDegree - std::acos(a.dot(b)),
                                             figure.anatomy.skeleton.joints[j].axes.col(0)));
  complete_pose(figure.anatomy.skeleton, pose);
  return pose;
}

// The lower lip and the chin go with the jaw, the upper lip and the nose stay.
TEST_F(BodySkin, MouthsOpenOnEveryBuild) {
  for (const BodySpec& spec : some_of(standard_bodies(), 1)) {
    const Figure body = figure(spec);
    const int jaw = int(body.joint("jaw"));
    const auto share = [&](int vertex) {
      double out = 0;
      for (const Influence& w : body.model->binding.joint_weights[std::size_t(vertex)])
        if (w.joint == jaw) out += w.weight;
      return out;
    };
    // Of the base mesh, in the middle from the nose to the chin.
    for (const int vertex : {317, 362, 468, 474}) EXPECT_LT(share(vertex), 0.1) << spec.name;
    for (const int vertex : {523, 495, 724, 5162}) EXPECT_GT(share(vertex), 0.9) << spec.name;
  }
}

TEST_F(BodySkin, BentElbowsAndKneesKeepTheirVolumeOnEveryBuild) {
  const std::vector<const char*> names{"default_male",  "default_female", "thin_male", "heavy_male",
                                       "muscular_male", "short_male",     "tall_male", "old_male"};
  for (const char* name : some_of(names, 2)) {
    Figure body = figure(standard_body(name));
    ASSERT_EQ(body.sections.size(), 4u);
    for (const auto& [upper, middle, lower, section] :
         {std::tuple{"shoulder_l", "elbow_l", "wrist_l", 0u},
          std::tuple{"shoulder_r", "elbow_r", "wrist_r", 1u},
          std::tuple{"hip_l", "knee_l", "ankle_l", 2u},
          std::tuple{"hip_r", "knee_r", "ankle_r", 3u}}) {
      const SkinFrame frame = body.play(bent_pose(body, upper, middle, lower));
      const SkinQuality mine = body.quality(frame), blend = body.quality(body.linear());
      EXPECT_EQ(mine.not_finite, 0);
      EXPECT_LE(mine.flipped_share, 0.001) << name << ' ' << middle;
      EXPECT_LE(mine.flipped, blend.flipped) << name << ' ' << middle;
      EXPECT_LT(blend.limb_volume_change[section], 0) << name << ' ' << middle;
      // A knee's section lies between rings of skin, which a bent knee draws down: it gets shorter.
      if (section < 2)
        EXPECT_LE(std::abs(mine.limb_volume_change[section]),
                  -0.5 * blend.limb_volume_change[section])
            << name << ' ' << middle;
    }
    const Skeleton& skeleton = body.anatomy.skeleton;
    const SkinFrame bent = body.play(pose_of_angles("knee 120", skeleton, name));
    const SkinFrame linear = body.linear();
    for (const LimbSection& leg : whole_limbs(skeleton, body.skin, body.model->binding))
      if (leg.name.starts_with("leg")) {
        EXPECT_LT(std::abs(section_change(leg, body.skin, bent)), 0.012) << name << ' ' << leg.name;
        EXPECT_LT(section_change(leg, body.skin, linear), 0) << name << ' ' << leg.name;
      }
  }
}

// As in people: a raised arm's flesh goes to chest and back, none comes from there.
TEST_F(BodySkin, ShouldersOfRaisedArmsLoseALittleAndGainNothing) {
  const std::vector<const char*> names{"thin_male", "default_female", "default_male", "heavy_male"};
  for (const char* name : some_of(names, 1, 2)) {
    Figure body = figure(standard_body(name));
    const Skeleton& skeleton = body.anatomy.skeleton;
    for (const char* arms : {"arm 90 0", "arm 90 90", "arm 150 0", "arm 175 45"}) {
      const SkinFrame frame = body.play(pose_of_angles(arms, skeleton, name));
      for (const LimbSection& section : whole_limbs(skeleton, body.skin, body.model->binding)) {
        if (!section.name.starts_with("shoulder")) continue;
        const double change = section_change(section, body.skin, frame);
        EXPECT_GT(change, -0.09) << name << ' ' << arms << ' ' << section.name;
        EXPECT_LT(change, 0.04) << name << ' ' << arms << ' ' << section.name;
      }
    }
  }
}

// A raised arm's skin is drawn towards the trunk, but its flesh stays about its bone: rings of skin
// from the middle of the upper arm on keep their centre on the humerus.
TEST_F(BodySkin, RaisedArmsStayAboutTheirBone) {
  // m, at the middle; two thirds of it farther down. Loose fat lags more.
  for (const auto& [name, most] : {std::pair{"default_male", 0.018}, {"heavy_male", 0.032}}) {
    Figure body = figure(standard_body(name));
    const Skeleton& skeleton = body.anatomy.skeleton;
    const std::vector<Vec3> at = rest_positions(skeleton);
    const size_t shoulder = body.joint("shoulder_l"), elbow = body.joint("elbow_l");
    const Vec3 axis = (at[elbow] - at[shoulder]).normalized();
    const double length = (at[elbow] - at[shoulder]).norm();
    for (const char* arms : {"arm 90 90", "arm 110 45", "arm 150 0"}) {
      const Pose pose = pose_of_angles(arms, skeleton, name);
      Points V;
      to_points(body.play(pose), V);
      std::vector<Transform> X_WJ;
      forward_kinematics(skeleton, pose, X_WJ);
      const Transform back = Eigen::Translation3d(at[shoulder]) * X_WJ[shoulder].inverse();
      for (const double from : {0.45, 0.6}) {
        Vec3 shift = Vec3::Zero();
        int count = 0;
        for (Eigen::Index i = 0; i < V.rows(); ++i) {
          const Vec3 rest = body.skin.V.row(i), arm = rest - at[shoulder];
          const double t = arm.dot(axis) / length;
          if (t < from || t > from + 0.15 || (arm - arm.dot(axis) * axis).norm() > 0.1) continue;
          shift += back * Vec3(V.row(i)) - rest;
          ++count;
        }
        ASSERT_GT(count, 10);
        shift /= count;
        const Vec3 across = shift - shift.dot(axis) * axis;
        EXPECT_LT(across.norm(), from < 0.5 ? most : most / 1.5)
            << name << ' ' << arms << ' ' << from;
      }
    }
  }
}

// The web before the armpit is not folded over the arm: there was a knob there in heavy bodies.
TEST_F(BodySkin, ArmsOverheadFoldNoKnobBeforeTheShoulder) {
  Figure body = figure(standard_body("heavy_male"));
  for (const char* arms : {"arm 175 45; elbow 5", "arm 160 90; elbow 5"}) {
    const SkinFrame frame = body.play(pose_of_angles(arms, body.anatomy.skeleton, "this test"));
    EXPECT_LT(
        measure_pose(body.skin, *body.model->skin.blend, body.posed.X_WJ, frame).flipped_outside,
        50)
        << arms;
  }
}

// The shoulder blade turns its medial border down; the trapezius glides over it.
TEST_F(BodySkin, MiddleTrapeziusShortensAsArmsRise) {
  const std::vector<const char*> names{"default_male", "default_female", "heavy_male"};
  for (const char* name : some_of(names, 1)) {
    Figure body = figure(standard_body(name));
    const auto lengths = [&](const char* arms) {
      body.play(pose_of_angles(arms, body.anatomy.skeleton, "this test"));
      std::vector<double> out;
      const std::vector<SliceRange> strips = slice_ranges(body.anatomy);
      for (std::size_t s = 0; s < strips.size(); ++s)
        if (body.anatomy.muscles[std::size_t(strips[s].muscle)].name.starts_with(
                "trapezius_middle"))
          out.push_back(body.posed.lengths[s]);
      return out;
    };
    const std::vector<double> hanging = lengths("arm 8 0"), raised = lengths("arm 150 30");
    ASSERT_EQ(hanging.size(), 8u);
    for (std::size_t s = 0; s < hanging.size(); ++s)
      if (s % 4 < 3)  // the lowest strip goes to the root of the spine, which turns outwards
        EXPECT_LT(raised[s], hanging[s]) << name << ' ' << s;
  }
}

TEST_F(BodySkin, WhatContactPressesAwaySwellsElsewhere) {
  Figure body = figure(standard_body("default_male"));
  for (const char* angles : {"knee 150", "elbow 150", "hip 110; knee 140; trunk 40 0 0"}) {
    const SkinFrame frame = body.play(pose_of_angles(angles, body.anatomy.skeleton, "this test"));
    EXPECT_LT(std::abs(measure_pose(body.skin, *body.model->skin.blend, body.posed.X_WJ, frame)
                           .body_volume_change),
              0.005)
        << angles;
  }
}

TEST_F(BodySkin, TenseMusclesThickenAsMeasuredInPeople) {
  const std::vector<const char*> names{"default_male", "default_female", "tall_male", "old_male"};
  for (const char* name : some_of(names)) {
    const Figure body = figure(standard_body(name));
    const Bulges bulges = measure_bulges(
        test::compile_figure(body.anatomy, body.skin, {.muscles = MuscleMotion::map}));
    EXPECT_EQ(bulges.muscles.size(), 5u);
    for (const Target& target : bulge_targets(bulges))
      EXPECT_TRUE(target.met) << name << ": " << target.what << ' ' << target.measured;
  }
}

TEST_F(BodySkin, AHeavyArmIsMeasuredWithoutTheTrunkItTouches) {
  BodySpec spec;
  spec.age = 87;
  spec.height = 1.55;
  spec.mass = 95;
  const Figure body = figure(spec);
  const Bulges bulges = measure_bulges(*body.model);
  EXPECT_GT(bulges.arm_relaxed, 0.3);
  EXPECT_NEAR(bulges.arm_flexed / bulges.arm_relaxed, 1, 0.15);
  EXPECT_NEAR(bulges.arm_tensed / bulges.arm_relaxed, 1, 0.15);
}

TEST_F(BodySkin, NoFoldsOverTheLongJump) {
  Figure body = figure(athlete());
  RetargetReport found;
  const Motion motion =
      retarget(read_motion(std::string(ECORCHE_TEST_DIR) + "/../data/motions/long_jump.bvh"),
               body.anatomy.skeleton, {}, found);
  for (size_t f = 0; f < motion.frames.size(); f += thorough() ? 2 : 8) {
    const SkinQuality mine = body.quality(body.play(motion.frames[f])),
                      blend = body.quality(body.linear());
    EXPECT_EQ(mine.not_finite, 0) << f;
    EXPECT_LE(mine.flipped_share, 0.001) << f;
    EXPECT_LE(mine.flipped, blend.flipped) << f;
  }
}

// Scapula and arm together turn more than half a circle against the chest: no vertex may jump while
// the sum passes it.
TEST_F(BodySkin, RaisedArmsMoveTheSkinSteadilyThroughHalfACircle) {
  Figure body = figure(standard_body("default_male"));
  const Skeleton& skeleton = body.anatomy.skeleton;
  const size_t scapula = body.joint("scapula_l"), shoulder = body.joint("shoulder_l");
  const double step = 0.5 * kDegree;
  Points before, now;
  for (double turn = 120 * kDegree; turn < 170 * kDegree; turn += step) {
    Pose pose = rest_pose(skeleton);
    pose.rotations[scapula] =
        Quat(Eigen::AngleAxisd(40 * kDegree, skeleton.joints[shoulder].axes.col(0)));
    pose.rotations[shoulder] = Quat(Eigen::AngleAxisd(turn, skeleton.joints[shoulder].axes.col(0)));
    to_points(body.play(pose), now);
    if (before.rows() == now.rows()) {
      EXPECT_LT((now - before).rowwise().norm().maxCoeff(), 1.5 * step)
          << turn / kDegree;  // an arm is less than 1 m long
    }
    before.swap(now);
  }
}

}  // namespace
}  // namespace ecorche
