// The window under a virtual display: it shows, picks and closes by itself.
#include "viewer/window.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "anatomy/errors.h"
#include "viewer/panels.h"

namespace ecorche {
namespace {

// One joint that carries one bone, a block of 0.4 m.
Anatomy block() {
  Anatomy a;
  a.skeleton.joints.resize(1);
  a.skeleton.joints[0].name = "pelvis";
  a.skeleton.joints[0].X_PJ.translation() = Vec3(0, 0.9, 0);
  Bone bone{"hip_bone_l", Side::left, 0, {}};
  bone.mesh.V.resize(8, 3);
  for (int k = 0; k < 8; ++k) bone.mesh.V.row(k) << (k & 1 ? 0.2 : -0.2), 0.9 + (k & 2 ? 0.2 : -0.2), (k & 4 ? 0.2 : -0.2);
  bone.mesh.F.resize(12, 3);
  bone.mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5;
  a.bones.push_back(bone);
  return a;
}

ViewSubject look_at(const Anatomy& a, const SceneModel& model) {
  return {a, model, 10, 30, [&a](int frame, PosedAnatomy& posed, SkinFrame&) {
            Pose pose = rest_pose(a.skeleton);
            pose.root.z() += 0.01 * frame;
            forward_kinematics(a.skeleton, pose, posed.X_WJ);
          }};
}

TEST(WindowTest, shows_picks_and_takes_a_picture) {
  if (!std::getenv("DISPLAY")) GTEST_SKIP() << "no display; run under xvfb-run";
  const Anatomy a = block();
  const SceneModel model = make_scene_model(a, {});
  const std::filesystem::path picture = std::filesystem::temp_directory_path() / "ecorche_window_test.png";
  std::filesystem::remove(picture);
  ViewDocument start;
  start.playing = true;
  const ViewDocument end = run_window(look_at(a, model), {.width = 640, .height = 480, .frames = 4, .screenshot = picture, .pick_x = 0.5, .pick_y = 0.5}, start);
  EXPECT_EQ(part_of(end.selected).kind, Part::Kind::bone);
  EXPECT_NEAR(end.time, 4.0 / 30, 1e-6);
  std::ifstream file(picture, std::ios::binary);
  std::string head(8, ' ');
  file.read(head.data(), 8);
  EXPECT_EQ(head, "\x89PNG\r\n\x1a\n");
  std::filesystem::remove(picture);
}

TEST(WindowTest, says_what_to_do_without_a_display) {
  const char* display = std::getenv("DISPLAY");
  const std::string before = display ? display : "";
  unsetenv("DISPLAY");
  const Anatomy a = block();
  const SceneModel model = make_scene_model(a, {});
  try {
    run_window(look_at(a, model), {.frames = 1});
    ADD_FAILURE() << "there was a window without a display";
  } catch (const OutputError& error) {
    EXPECT_NE(std::string(error.what()).find("ecorche render"), std::string::npos) << error.what();
  }
  EXPECT_THROW(run_window(look_at(a, model), {.width = 0}), UsageError);
  if (display) setenv("DISPLAY", before.c_str(), 1);
}

TEST(PanelsTest, a_part_is_described_for_people) {
  const Anatomy a = block();
  const SceneModel model = make_scene_model(a, {});
  const PartInfo info = describe(look_at(a, model), {}, kFirstBonePart);
  EXPECT_EQ(info.label, "hip bone l");
  EXPECT_EQ(info.joint, "pelvis");
  EXPECT_EQ(describe(look_at(a, model), {}, kFirstBonePart + 99).name, "");
  EXPECT_EQ(describe(look_at(a, model), {}, 0).name, "");
}

}  // namespace
}  // namespace ecorche
