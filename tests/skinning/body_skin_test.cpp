// The template's own skin beside linear blend skinning with the body package's weights, on hard poses.
#include <gtest/gtest.h>

#include <numbers>

#include "anatomy/errors.h"
#include "morph/template.h"
#include "skinning/bind.h"
#include "skinning/deform.h"
#include "skinning/linear_rival.h"
#include "skinning/quality.h"
#include "tests/body_fixture.h"

namespace ecorche {
namespace {

class BodySkin : public BodyFixture {};

TEST_F(BodySkin, BentElbowAndKneeBeatTheLinearBlend) {
  Template body;
  try {
    body = read_template();
  } catch (const InputError& error) {
    GTEST_SKIP() << error.what();
  }
  const Skeleton& skeleton = body.anatomy.skeleton;
  const PosingTable table = make_posing_table(body.anatomy);
  const Binding binding = bind_skin(body.anatomy, body.body);
  const LinearRival rival = make_linear_rival(package(), skeleton, body.body.skin);
  const std::vector<LimbSection> sections = limb_sections(skeleton, body.body.skin, binding);
  ASSERT_EQ(sections.size(), 4u);
  const std::vector<Vec3> at = rest_positions(skeleton);
  const auto joint = [&](const char* name) { return static_cast<std::size_t>(find_joint(skeleton, name)); };
  for (const auto& [upper, middle, lower, section] :
       {std::tuple{"shoulder_l", "elbow_l", "wrist_l", 0u}, std::tuple{"hip_l", "knee_l", "ankle_l", 2u}}) {
    const Vec3 a = (at[joint(middle)] - at[joint(upper)]).normalized(), b = (at[joint(lower)] - at[joint(middle)]).normalized();
    Pose pose = rest_pose(skeleton);
    const double turn = 2 * std::numbers::pi / 3 - std::acos(a.dot(b));
    pose.rotations[joint(middle)] = Quat(Eigen::AngleAxisd(turn, skeleton.joints[joint(middle)].axes.col(0)));
    complete_pose(skeleton, pose);
    PosedAnatomy posed;
    pose_anatomy(table, skeleton, pose, posed);
    SkinFrame ours, theirs;
    deform_skin(binding, posed, ours);
    deform_rival(rival, skeleton, posed.X_WJ, theirs);
    const SkinQuality mine = measure_skin(body.body.skin, binding, sections, posed.X_WJ, ours);
    const SkinQuality blend = measure_skin(body.body.skin, binding, sections, posed.X_WJ, theirs);
    EXPECT_EQ(mine.not_finite, 0);
    EXPECT_LE(mine.flipped_share, 0.001) << middle;
    EXPECT_LE(mine.flipped, blend.flipped) << middle;
    EXPECT_GE(mine.limb_volume_change[section], 0.5 * blend.limb_volume_change[section]) << middle;
  }
}

}  // namespace
}  // namespace ecorche
