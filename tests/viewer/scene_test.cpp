// Laws of scenes and films on a figure of two bones and one muscle.
#include "viewer/scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include "anatomy/errors.h"
#include "viewer/camera.h"
#include "viewer/film.h"
#include "viewer/follow_camera.h"
#include "viewer/view_document.h"

namespace ecorche {
namespace {

TriMesh box(const Vec3& low, const Vec3& high) {
  TriMesh mesh;
  mesh.V.resize(8, 3);
  for (int k = 0; k < 8; ++k) mesh.V.row(k) << (k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z();
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5;
  return mesh;
}

Anatomy arm() {
  Anatomy a;
  a.skeleton.joints.resize(2);
  a.skeleton.joints[0].name = "shoulder";
  a.skeleton.joints[0].X_PJ.translation() = Vec3(0, 1, 0);
  a.skeleton.joints[1].name = "elbow";
  a.skeleton.joints[1].parent = 0;
  a.skeleton.joints[1].X_PJ.translation() = Vec3(0, -0.3, 0);
  a.bones.push_back({"upper", Side::middle, 0, box({-0.02, 0.72, -0.02}, {0.02, 1.0, 0.02})});
  a.bones.push_back({"lower", Side::middle, 1, box({-0.02, 0.4, -0.02}, {0.02, 0.68, 0.02})});
  Muscle m;
  m.name = m.label = "flexor";
  m.volume = 1e-4;
  Strip strip;
  strip.path = {{Vec3(0, 0.95, 0.06), {0, -1}, 1}, {Vec3(0, 0.8, 0.07), {0, -1}, 1}, {Vec3(0, 0.6, 0.04), {1, -1}, 1}};
  for (int k = 0; k < 8; ++k) strip.slices.push_back({k / 7.0, 0, Vec2::Zero(), Vec2(0.02, 0.015)});
  strip.belly_begin = 0.2;
  strip.belly_end = 0.7;
  strip.rest_length = 0.36;
  m.strips.push_back(strip);
  a.muscles.push_back(m);
  return a;
}

PosedAnatomy posed_arm(const Anatomy& a, double bend) {
  Pose pose = rest_pose(a.skeleton);
  pose.rotations[1] = Quat(Eigen::AngleAxisd(-bend, Vec3::UnitX()));
  PosedAnatomy posed;
  pose_anatomy(make_posing_table(a), a.skeleton, pose, posed);
  return posed;
}

const TriMesh arm_skin = box({-0.1, 0.35, -0.1}, {0.1, 1.05, 0.12});

TEST(SceneTest, part_numbers_come_back) {
  EXPECT_EQ(part_of(0).kind, Part::Kind::none);
  EXPECT_EQ(part_of(kSkinPart).kind, Part::Kind::skin);
  EXPECT_EQ(part_of(kFirstBonePart + 177).index, 177);
  EXPECT_EQ(part_of(kFirstBonePart + 177).kind, Part::Kind::bone);
  EXPECT_EQ(part_of(kFirstMusclePart + 3).kind, Part::Kind::muscle);
  EXPECT_EQ(part_of(kFirstMusclePart + 3).index, 3);
}

TEST(SceneTest, bones_stand_where_kinematics_puts_them) {
  const Anatomy a = arm();
  const SceneModel model = make_scene_model(a, arm_skin);
  const PosedAnatomy posed = posed_arm(a, 1.2);
  Scene scene;
  update_scene(model, posed, nullptr, {}, {}, 1, scene);
  for (const DrawItem& item : scene.list.items) {
    const Part part = part_of(item.part);
    if (part.kind != Part::Kind::bone) continue;
    const Bone& bone = a.bones[part.index];
    const Vec3 rest_joint = rest_positions(a.skeleton)[bone.joint];
    for (Eigen::Index i = 0; i < bone.mesh.V.rows(); ++i) {
      const Vec3 expected = posed.X_WJ[bone.joint] * (bone.mesh.V.row(i).transpose() - rest_joint);
      const Vec4f drawn = item.X_WM * scene.list.meshes[item.mesh].positions[i].homogeneous();
      EXPECT_LT((drawn.head<3>().cast<double>() - expected).norm(), 1e-6);
    }
  }
}

TEST(SceneTest, layers_that_are_off_are_not_drawn) {
  const Anatomy a = arm();
  const SceneModel model = make_scene_model(a, arm_skin);
  Scene scene;
  Appearance appearance;
  auto kinds = [&](Look look) {
    appearance.looks = {look};
    update_scene(model, posed_arm(a, 0), nullptr, {}, appearance, 1, scene);
    std::multiset<int> meshes;
    for (const DrawItem& item : scene.list.items) meshes.insert(item.mesh);
    return meshes;
  };
  EXPECT_EQ(kinds({.skin = 1, .muscles = 0, .bones = 0}), (std::multiset<int>{0}));
  EXPECT_EQ(kinds({.skin = 0, .muscles = 1, .bones = 0}), (std::multiset<int>{1}));
  EXPECT_EQ(kinds({.skin = 0, .muscles = 0, .bones = 1}), (std::multiset<int>{2, 3}));
  EXPECT_EQ(kinds({.skin = 1, .skin_dissolved = 1, .muscles = 0, .bones = 0}), (std::multiset<int>{}));
}

TEST(SceneTest, a_shortened_muscle_is_brighter_and_a_stretched_one_darker) {
  const Anatomy a = arm();
  const SceneModel model = make_scene_model(a, arm_skin);
  const PosedAnatomy posed = posed_arm(a, 0.3);
  auto belly_light = [&](float activity, MuscleColors colors) {
    Scene scene;
    Appearance appearance;
    appearance.muscle_colors = colors;
    update_scene(model, posed, nullptr, std::vector<float>{activity}, appearance, 1, scene);
    float most = 0;
    for (int i = 0; i < model.surface.vertices(); ++i)
      if (model.surface.belly[i] > 0.99f) most = std::max(most, scene.list.meshes[1].colors[i].sum());
    return most;
  };
  EXPECT_GT(belly_light(1, MuscleColors::flesh), belly_light(0, MuscleColors::flesh) + 0.1f);
  EXPECT_LT(belly_light(-1, MuscleColors::flesh), belly_light(0, MuscleColors::flesh) - 0.05f);
  EXPECT_LT(belly_light(1, MuscleColors::shortening), belly_light(0, MuscleColors::shortening));
}

TEST(SceneTest, shortening_has_the_sign_of_the_length) {
  const Anatomy a = arm();
  const SceneModel model = make_scene_model(a, arm_skin);
  PosedAnatomy posed = posed_arm(a, 0);
  std::vector<float> out;
  posed.lengths[0] = 0.36 * 0.9;
  muscle_shortening(model, posed, out);
  EXPECT_NEAR(out[0], 0.5, 1e-5);
  posed.lengths[0] = 0.36 * 1.5;
  muscle_shortening(model, posed, out);
  EXPECT_NEAR(out[0], -1, 1e-5);
}

TEST(SceneTest, values_of_another_character_are_refused) {
  const Anatomy a = arm();
  const SceneModel model = make_scene_model(a, arm_skin);
  Scene scene;
  PosedAnatomy posed = posed_arm(a, 0);
  EXPECT_THROW(update_scene(model, posed, nullptr, std::vector<float>(7), {}, 1, scene), std::invalid_argument);
  SkinFrame skin;
  skin.positions.resize(4);
  EXPECT_THROW(update_scene(model, posed, &skin, {}, {}, 1, scene), std::invalid_argument);
  posed.X_WJ.pop_back();
  EXPECT_THROW(update_scene(model, posed, nullptr, {}, {}, 1, scene), std::invalid_argument);
}

// A runner 7.5 m/s fast, bobbing, who leaps 0.8 m high with the arms up between frames 120 and 150.
std::vector<std::vector<Vec3f>> running_figure() {
  std::vector<std::vector<Vec3f>> figures;
  for (int f = 0; f < 240; ++f) {
    const float flight = f > 120 && f < 150 ? 0.8f * std::sin(static_cast<float>(f - 120) / 30 * 3.14159f) : 0;
    const float foot = flight + 0.05f * std::sin(static_cast<float>(f) * 0.9f), z = 0.25f * static_cast<float>(f);
    figures.push_back({{0, 0, z}, {0, foot, z - 0.5f}, {0, foot + (flight > 0 ? 2.2f : 1.8f), z}, {0.2f, foot + 1, z + 0.5f}});
  }
  return figures;
}

TEST(FollowTest, the_camera_keeps_the_whole_athlete_in_sight_and_does_not_shake) {
  const auto figures = running_figure();
  for (const float aspect : {16.0f / 9, 0.6f}) {
    const std::vector<Camera> cameras = follow(figures, 30, {.aspect = aspect});
    ASSERT_EQ(cameras.size(), figures.size());
    for (std::size_t f = 0; f < figures.size(); ++f) {
      for (const Vec3f& point : figures[f]) {
        const Vec4f p = projection_matrix(cameras[f], aspect) * view_matrix(cameras[f]) * point.homogeneous();
        EXPECT_LT(p.head<2>().cwiseAbs().maxCoeff(), 0.9401f * p.w()) << "beyond the margin in frame " << f;
      }
      if (f > 1) {
        EXPECT_LT((cameras[f].eye - 2 * cameras[f - 1].eye + cameras[f - 2].eye).norm(), 0.03f) << f;
      }
    }
    EXPECT_LT(cameras.back().eye.x(), -3) << "ends on the right side: the athlete goes from left to right";
  }
  EXPECT_TRUE(follow({}, 30).empty());
}

class FilmTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / fmt::format("ecorche_film_{}", ::getpid());
    std::filesystem::create_directories(folder_);
    try {
      Renderer probe;
    } catch (const OutputError& error) {
      GTEST_SKIP() << error.what();
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // The arm bends; the camera stands.
  static FrameSource source() {
    const Anatomy a = arm();
    return [a, model = make_scene_model(a, arm_skin)](int f, Scene& scene) {
      Appearance appearance;
      appearance.looks[0].skin = 0.2f;
      update_scene(model, posed_arm(a, 0.1 * f), nullptr, {}, appearance, static_cast<std::uint64_t>(f) + 1, scene);
      scene.list.camera = orbit_camera({0, 0.7f, 0}, 0.5f, 0.6f, 0.1f);
    };
  }
  static std::string bytes(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  bool empty() const { return std::filesystem::is_empty(folder_); }
  std::filesystem::path folder_;
};

TEST_F(FilmTest, pictures_are_numbered_and_differ) {
  FilmOptions options{.output = folder_ / "%04d.png", .width = 61, .height = 40};
  const FilmReport report = make_film(options, 4, source());
  EXPECT_EQ(report.frames, 4);
  EXPECT_EQ(report.width, 61);
  std::set<std::string> different;
  for (const char* name : {"0001.png", "0002.png", "0003.png", "0004.png"}) different.insert(bytes(folder_ / name));
  EXPECT_EQ(different.size(), 4u);
  EXPECT_FALSE(different.contains(""));
}

TEST_F(FilmTest, two_scenes_in_turn_draw_what_one_would) {
  make_film({.output = folder_ / "%d.png", .width = 60, .height = 40}, 6, source());
  Renderer renderer;
  Scene scene;
  for (int f = 0; f < 6; ++f) {
    source()(f, scene);
    const std::vector<std::uint8_t> alone = encode_png(renderer.render(scene.list, 60, 40));
    EXPECT_EQ(bytes(folder_ / fmt::format("{}.png", f + 1)), std::string(alone.begin(), alone.end())) << f;
  }
}

TEST_F(FilmTest, a_film_of_odd_size_is_made_even_and_the_same_twice) {
  FilmOptions options{.output = folder_ / "a.mp4", .width = 63, .height = 41};
  FilmReport report;
  try {
    report = make_film(options, 5, source());
  } catch (const OutputError& error) {
    GTEST_SKIP() << error.what();
  }
  EXPECT_EQ(report.width, 64);
  EXPECT_EQ(report.height, 42);
  options.output = folder_ / "b.mp4";
  make_film(options, 5, source());
  EXPECT_GT(bytes(folder_ / "a.mp4").size(), 500u);
  EXPECT_EQ(bytes(folder_ / "a.mp4"), bytes(folder_ / "b.mp4"));
}

TEST_F(FilmTest, what_cannot_be_made_is_refused_and_leaves_nothing) {
  EXPECT_THROW(make_film({.output = folder_ / "a.mp4"}, 0, source()), UsageError);
  EXPECT_THROW(make_film({.output = folder_ / "a.gif"}, 2, source()), UsageError);
  EXPECT_THROW(make_film({.output = folder_ / "%s.png"}, 2, source()), UsageError);
  EXPECT_THROW(make_film({.output = folder_ / "%d%d.png"}, 2, source()), UsageError);
  EXPECT_THROW(make_film({.output = folder_ / "a.mp4", .width = 0}, 2, source()), UsageError);
  EXPECT_THROW(make_film({.output = folder_ / "a.mp4", .width = 20000}, 2, source()), LimitError);
  EXPECT_THROW(make_film({.output = folder_ / "none" / "a.mp4"}, 2, source()), OutputError);
  EXPECT_THROW(make_film({.output = "/dev/null/none/%d.png"}, 2, source()), OutputError);
  FilmOptions options{.output = folder_ / "a.mp4", .width = 64, .height = 40};
  options.video.fps = 0;
  EXPECT_THROW(make_film(options, 2, source()), UsageError);
  options.video = {.program = "no-such-program"};
  EXPECT_THROW(make_film(options, 2, source()), OutputError);
  options.video = {.program = "false"};
  EXPECT_THROW(make_film(options, 2, source()), OutputError);
  EXPECT_TRUE(empty());
}

TEST_F(FilmTest, the_folder_of_numbered_pictures_is_made) {
  make_film({.output = folder_ / "new" / "deep" / "%d.png", .width = 32, .height = 20}, 2, source());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "new" / "deep" / "2.png"));
}

TEST_F(FilmTest, an_error_of_the_source_comes_out_and_no_film_stays) {
  const FrameSource failing = [inner = source()](int f, Scene& scene) {
    if (f == 3) throw InputError("frame 3 is broken");
    inner(f, scene);
  };
  EXPECT_THROW(make_film({.output = folder_ / "a.mp4", .width = 64, .height = 40}, 6, failing), InputError);
  EXPECT_TRUE(empty());
}

TEST(ViewDocumentTest, the_clock_and_the_mouse) {
  const Anatomy a = arm();
  const SceneModel model = make_scene_model(a, arm_skin);
  const ViewSubject subject{a, model, 30, 10, {}};
  ViewDocument document;
  advance(subject, 1, document);
  EXPECT_EQ(document.time, 0) << "it stands until it is played";
  document.playing = true;
  advance(subject, 2.55, document);
  EXPECT_EQ(frame_of(subject, document), 25);
  advance(subject, 1, document);
  EXPECT_NEAR(document.time, 0.55, 1e-9) << "begins again";
  orbit(0, 1e6f, document);
  EXPECT_LT(document.elevation, std::numbers::pi_v<float> / 2);
  zoom(1000, document);
  EXPECT_GT(document.radius, 0);
  const Vec3f before = document.center;
  document.azimuth = 0;
  document.elevation = 0;
  pan(10, 0, 800, document);
  EXPECT_LT(document.center.x(), before.x()) << "the body goes with the mouse";
}

}  // namespace
}  // namespace ecorche
