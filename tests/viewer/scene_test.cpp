// Laws of scenes and films on a figure of two bones and one muscle.
#include "viewer/scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include "anatomy/errors.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "viewer/camera.h"
#include "viewer/coarse_mesh.h"
#include "viewer/coarse_scene.h"
#include "viewer/film/film.h"
#include "viewer/follow_camera.h"
#include "viewer/part_names.h"
#include "viewer/scene_meshes.h"
#include "viewer/window/view_document.h"

namespace ecorche {
namespace {

TriMesh box(const Vec3& low, const Vec3& high) {
  TriMesh mesh;
  mesh.V.resize(8, 3);
  for (int k = 0; k < 8; ++k)
    mesh.V.row(k) << (k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z();
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4,
      6, 1, 3, 5, 3, 7, 5;
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
  strip.path = {{Vec3(0, 0.95, 0.06), {0, -1}, 1},
                {Vec3(0, 0.8, 0.07), {0, -1}, 1},
                {Vec3(0, 0.6, 0.04), {1, -1}, 1}};
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
  EXPECT_EQ(kinds({.skin = 0, .muscles = 0, .bones = 1}), (std::multiset<int>{3, 4}));
  EXPECT_EQ(kinds({.skin = 1, .skin_dissolved = 1, .muscles = 0, .bones = 0}),
            (std::multiset<int>{}));
}

TEST(SceneTest, hidden_parts_are_not_drawn_and_come_back) {
  const Anatomy a = arm();
  const SceneModel model = make_scene_model(a, arm_skin);
  Scene scene;
  Appearance appearance;
  const auto parts = [&](std::vector<std::uint32_t> hidden) {
    appearance.hidden = std::move(hidden);
    update_scene(model, posed_arm(a, 0), nullptr, {}, appearance, 1, scene);
    std::set<std::uint32_t> drawn;
    for (const DrawItem& item : scene.list.items) {
      const DrawMesh& mesh = scene.list.meshes[item.mesh];
      for (const Triangle32& t : mesh.triangles)
        drawn.insert(mesh.parts.empty() ? item.part : mesh.parts[t[0]]);
    }
    return drawn;
  };
  const std::uint32_t upper = kFirstBonePart, lower = kFirstBonePart + 1, flexor = kFirstMusclePart;
  const std::set<std::uint32_t> all{kSkinPart, upper, lower, flexor};
  EXPECT_EQ(parts({}), all);
  const std::uint64_t whole = scene.list.meshes[1].faces;
  EXPECT_EQ(parts({upper}), (std::set<std::uint32_t>{kSkinPart, lower, flexor}));
  EXPECT_EQ(parts({kSkinPart, flexor}), (std::set<std::uint32_t>{upper, lower}));
  EXPECT_NE(scene.list.meshes[1].faces, whole) << "the renderer has to send it again";
  EXPECT_EQ(parts({}), all);
  EXPECT_EQ(scene.list.meshes[1].faces, whole);
}

TEST(SceneTest, fascia_is_drawn_with_muscles_and_can_be_hidden) {
  Anatomy a = arm();
  FasciaSheet sheet;
  sheet.name = "cover_l";
  sheet.label = "cover";
  sheet.group = "arm";
  sheet.side = Side::left;
  sheet.rows = sheet.columns = 2;
  const Vec3 at = rest_positions(a.skeleton)[0];
  sheet.V.resize(4, 3);
  for (int i = 0; i < 4; ++i) sheet.V.row(i) = at + 0.01 * Vec3(i % 2, i / 2, 0);
  sheet.belly.assign(4, 0);
  a.fascia.push_back(sheet);
  const SceneModel model = make_scene_model(a, arm_skin);
  Scene scene;
  Appearance appearance;
  const auto drawn = [&] {
    update_scene(model, posed_arm(a, 0), nullptr, {}, appearance, 1, scene);
    return std::ranges::any_of(scene.list.items,
                               [](const DrawItem& item) { return item.mesh == 2; });
  };
  appearance.looks = {{.skin = 0, .muscles = 1, .bones = 0}};
  EXPECT_TRUE(drawn());
  appearance.hidden = parts_named(a, "fascia");
  EXPECT_EQ(appearance.hidden, (std::vector<std::uint32_t>{kFirstFasciaPart}));
  EXPECT_FALSE(drawn());
  appearance.hidden.clear();
  EXPECT_TRUE(drawn());
  appearance.looks = {{.skin = 1, .muscles = 0, .bones = 1}};
  EXPECT_FALSE(drawn());
  EXPECT_EQ(part_of(kFirstFasciaPart).kind, Part::Kind::fascia);
  EXPECT_EQ(part_name(a, kFirstFasciaPart), "cover_l");
  EXPECT_EQ(part_label(a, kFirstFasciaPart), "cover, left");
}

TEST(PartNamesTest, names_mean_what_people_mean_by_them) {
  Anatomy a = arm();
  a.bones[0].name = "femur_l", a.bones[0].side = Side::left;
  a.bones[1].name = "femur_r", a.bones[1].side = Side::right;
  const Muscle flexor = a.muscles[0];
  a.muscles.clear();
  for (const char* name : {"biceps_femoris_long_l", "biceps_femoris_long_r",
                           "biceps_femoris_short_l", "rectus_femoris_l"}) {
    a.muscles.push_back(flexor);
    a.muscles.back().name = name;
    a.muscles.back().side = std::string_view(name).ends_with("_l") ? Side::left : Side::right;
    a.muscles.back().group =
        std::string_view(name).starts_with("rectus") ? "thigh_front" : "thigh_back";
    a.muscles.back().layer = "superficial";
  }
  const std::uint32_t bone = kFirstBonePart, muscle = kFirstMusclePart;
  using Parts = std::vector<std::uint32_t>;
  EXPECT_EQ(parts_named(a, "femur_l"), (Parts{bone}));
  EXPECT_EQ(parts_named(a, "Femur"), (Parts{bone, bone + 1}));
  EXPECT_EQ(parts_named(a, "biceps femoris"), (Parts{muscle, muscle + 1, muscle + 2}));
  EXPECT_EQ(parts_named(a, "biceps_l"), (Parts{muscle, muscle + 2}));
  EXPECT_EQ(parts_named(a, "bic"), Parts{}) << "a name ends at a joint of words";
  EXPECT_EQ(parts_named(a, "*short*"), (Parts{muscle + 2}));
  EXPECT_EQ(parts_named(a, "thigh_front"), (Parts{muscle + 3}));
  EXPECT_EQ(parts_named(a, "thigh_r"), (Parts{muscle + 1}));
  EXPECT_EQ(parts_named(a, "superficial").size(), 4u);
  EXPECT_EQ(parts_named(a, "bones"), (Parts{bone, bone + 1}));
  EXPECT_EQ(parts_named(a, "skin"), (Parts{kSkinPart}));
  EXPECT_EQ(parts_named(a, ""), Parts{});
  EXPECT_EQ(parts_of_list(a, "skin,femur_r,femur", "--hide"), (Parts{kSkinPart, bone, bone + 1}));
  EXPECT_EQ(parts_of_list(a, "", "--hide"), Parts{});
  try {
    parts_of_list(a, "skin,femr", "--hide");
    ADD_FAILURE();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("'femur'"), std::string::npos) << error.what();
  }
  EXPECT_EQ(part_label(a, bone), "femur, left");
  EXPECT_EQ(part_label(a, muscle + 1), "flexor, right");
  EXPECT_EQ(part_label(a, bone + 7), "");
  EXPECT_EQ(all_parts(a).size(), 8u);
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
      if (model.surface.belly[i] > 0.99f)
        most = std::max(most, scene.list.meshes[1].colors[i].sum());
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
  EXPECT_THROW(update_scene(model, posed, nullptr, std::vector<float>(7), {}, 1, scene),
               std::invalid_argument);
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
    const float flight = f > 120 && f < 150 ? 0.8f * std::sin(float(f - 120) / 30 * 3.14159f) : 0;
    const float foot = flight + 0.05f * std::sin(float(f) * 0.9f), z = 0.25f * float(f);
    figures.push_back({{0, 0, z},
                       {0, foot, z - 0.5f},
                       {0, foot + (flight > 0 ? 2.2f : 1.8f), z},
                       {0.2f, foot + 1, z + 0.5f}});
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
        const Vec4f p =
            projection_matrix(cameras[f], aspect) * view_matrix(cameras[f]) * point.homogeneous();
        EXPECT_LT(p.head<2>().cwiseAbs().maxCoeff(), 0.9401f * p.w())
            << "beyond the margin in frame " << f;
      }
      if (f > 1) {
        EXPECT_LT((cameras[f].eye - 2 * cameras[f - 1].eye + cameras[f - 2].eye).norm(), 0.03f)
            << f;
      }
    }
    EXPECT_LT(cameras.back().eye.x(), -3)
        << "ends on the right side: the athlete goes from left to right";
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
      update_scene(model, posed_arm(a, 0.1 * f), nullptr, {}, appearance, std::uint64_t(f) + 1,
                   scene);
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
  for (const char* name : {"0001.png", "0002.png", "0003.png", "0004.png"})
    different.insert(bytes(folder_ / name));
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
    EXPECT_EQ(bytes(folder_ / fmt::format("{}.png", f + 1)),
              std::string(alone.begin(), alone.end()))
        << f;
  }
}

TEST_F(FilmTest, two_scenes_are_halves_of_a_picture_or_wiped_over_each_other) {
  Renderer renderer;
  Scene scene;
  const auto alone = [&](int f, int width) {
    source()(f, scene);
    return renderer.render(scene.list, width, 40);
  };
  for (const Pairing pairing : {Pairing::beside, Pairing::wiped}) {
    Image seen;
    FilmOptions options{.output = folder_ / "still.png", .width = 60, .height = 40};
    options.pairing = pairing;
    options.wipe = 0.25f;
    options.finish = [&](int frame, Image& picture) {
      EXPECT_EQ(frame, 0);
      seen = picture;
    };
    EXPECT_EQ(make_film(options, 1, source()).frames, 1);
    const bool beside = pairing == Pairing::beside;
    const Image first = alone(0, beside ? 30 : 60), second = alone(1, beside ? 30 : 60);
    const int line = beside ? 30 : 15;
    int differ = 0;
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 60; ++x) {
        const std::uint8_t* from =
            x < line ? first.pixel(x, y) : second.pixel(beside ? x - line : x, y);
        differ += !std::equal(from, from + 3, seen.pixel(x, y));
      }
    EXPECT_EQ(differ, 0);
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
  make_film({.output = folder_ / "new" / "deep" / "%d.png", .width = 32, .height = 20}, 2,
            source());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "new" / "deep" / "2.png"));
}

TEST_F(FilmTest, an_error_of_the_source_comes_out_and_no_film_stays) {
  const FrameSource failing = [inner = source()](int f, Scene& scene) {
    if (f == 3) throw InputError("frame 3 is broken");
    inner(f, scene);
  };
  EXPECT_THROW(make_film({.output = folder_ / "a.mp4", .width = 64, .height = 40}, 6, failing),
               InputError);
  EXPECT_TRUE(empty());
}

TEST(ViewDocumentTest, the_clock_and_the_mouse) {
  const Anatomy a = arm();
  const SceneModel model = make_scene_model(a, arm_skin);
  const ViewSubject subject{.anatomy = &a, .model = &model, .frames = 30, .fps = 10};
  ViewDocument document;
  advance(subject, 1, document);
  EXPECT_EQ(document.time, 0) << "it stands until it is played";
  document.playing = true;
  advance(subject, 2.55, document);
  EXPECT_EQ(frame_of(subject, document), 25);
  advance(subject, 1, document);
  EXPECT_NEAR(document.time, 0.55, 1e-9) << "begins again";
  orbit(0, 1e6f, document);
  EXPECT_LE(document.elevation, std::numbers::pi_v<float> / 2);
  zoom(1000, document);
  EXPECT_GT(document.radius, 0);
  const Vec3f before = document.center;
  document.azimuth = 0;
  document.elevation = 0;
  pan(10, 0, 800, document);
  EXPECT_LT(document.center.x(), before.x()) << "the body goes with the mouse";
}

// Where a point is seen, in pixels from the upper left.
Eigen::Vector2f seen_at(const Camera& camera, const Vec3f& p, float width, float height) {
  const Vec4f clip =
      projection_matrix(camera, width / height) * view_matrix(camera) * p.homogeneous();
  return {0.5f * (1 + clip.x() / clip.w()) * width, 0.5f * (1 - clip.y() / clip.w()) * height};
}

TEST(ViewDocumentTest, a_motion_plays_between_its_marks) {
  ViewSubject subject;
  subject.frames = 100;
  subject.fps = 10;
  ViewDocument document;
  go_to(subject, 20, document);
  mark(subject, &ViewDocument::in, document);
  go_to(subject, 29, document);
  mark(subject, &ViewDocument::out, document);
  document.playing = true;
  for (int k = 0; k < 40; ++k) {
    advance(subject, 0.17, document);
    EXPECT_GE(frame_of(subject, document), 20);
    EXPECT_LE(frame_of(subject, document), 29);
  }
  go_to(subject, 10, document);
  mark(subject, &ViewDocument::out, document);
  EXPECT_FALSE(document.in) << "nothing lies between";
  mark(subject, &ViewDocument::out, document);
  EXPECT_FALSE(document.out) << "the same again takes it away";
}

TEST(ViewDocumentTest, a_cut_goes_through_the_middle_of_the_view_and_stays_within_the_figure) {
  ViewSubject subject;
  subject.bounds = {Vec3f(-0.5f, 0, -0.2f), Vec3f(0.5f, 1.8f, 0.2f)};
  ViewDocument document;
  document.center = {0.1f, 0.4f, -0.05f};
  using Kind = SectionPlane::Kind;
  for (const auto& [kind, place] :
       {std::pair{Kind::transverse, 0.4}, {Kind::frontal, -0.05}, {Kind::sagittal, 0.1}}) {
    next_section(subject, document);
    EXPECT_EQ(document.section.kind, kind);
    EXPECT_NEAR(document.section.place, place, 1e-6);
  }
  move_section(subject, 5, document);
  EXPECT_NEAR(document.section.place, 0.105, 1e-6);
  for (int k = 0; k < 100; ++k) move_section(subject, 5, document);
  EXPECT_NEAR(document.section.place, 0.5, 1e-6);
  next_section(subject, document);
  EXPECT_EQ(document.section.kind, Kind::none);
}

TEST(ViewDocumentTest, the_whole_figure_is_in_its_room_tall_or_short_from_every_side) {
  const Anatomy a = arm();
  const SceneModel model = make_scene_model(a, arm_skin);
  ViewSubject subject{.anatomy = &a, .model = &model};
  const Vec3f root(3, 0.95f, -2);
  for (const float stature : {1.41f, 1.75f, 2.05f})
    for (const auto& [width, height] :
         {std::pair{1280.0f, 800.0f}, {700.0f, 900.0f}, {1920.0f, 500.0f}})
      for (const char* view : {"front", "left", "top", "bottom", "oblique", "140,-30"})
        for (const bool parallel : {false, true}) {
          subject.bounds = {Vec3f(-0.3f * stature, 0, -0.1f), Vec3f(0.3f * stature, stature, 0.2f)};
          const ViewRoom room{250, 0, width - 250 - 200, height - 60};
          ViewDocument document;
          document.parallel = parallel;
          document.azimuth = view_angles(view).azimuth;
          document.elevation = view_angles(view).elevation;
          frame_figure(subject, room, document);
          const Camera camera = camera_of(document, root, width, height, room);
          float highest = 0;
          for (int k = 0; k < 8; ++k) {
            const Vec3f corner =
                subject.bounds.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k)) +
                Vec3f(root.x(), 0, root.z());
            const Eigen::Vector2f p = seen_at(camera, corner, width, height);
            const std::string where =
                fmt::format("{} m, {} x {}, {}{}: ({}, {})", stature, width, height, view,
                            parallel ? ", parallel" : "", p.x(), p.y());
            EXPECT_GE(p.x(), room.x) << where;
            EXPECT_LE(p.x(), room.x + room.width) << where;
            EXPECT_GE(p.y(), room.y) << where;
            EXPECT_LE(p.y(), room.y + room.height) << where;
            highest =
                std::max({highest, std::abs(p.y() - (room.y + 0.5f * room.height)) / room.height,
                          std::abs(p.x() - (room.x + 0.5f * room.width)) / room.width});
          }
          EXPECT_GT(highest, 0.4f) << "and it fills it";
        }
}

// Both sides of a sheet, 0.2 mm apart and joined at one edge.
struct Sheet {
  std::vector<Vec3f> positions, normals;
  std::vector<Triangle32> triangles;
};
Sheet thin_sheet(int count) {
  Sheet out;
  const auto at = [&](int side, int i, int k) {
    return std::uint32_t((side * count + i) * count + k);
  };
  for (const int side : {0, 1})
    for (int i = 0; i < count; ++i)
      for (int k = 0; k < count; ++k) {
        out.positions.emplace_back(0.002f * float(i), 0.0002f * float(side), 0.002f * float(k));
        out.normals.emplace_back(0, side == 1 ? 1.0f : -1.0f, 0);
        if (i == 0 || k == 0) continue;
        out.triangles.emplace_back(at(side, i, k), at(side, i - 1, k), at(side, i, k - 1));
        out.triangles.emplace_back(at(side, i - 1, k), at(side, i - 1, k - 1), at(side, i, k - 1));
      }
  for (int k = 1; k < count; ++k)
    out.triangles.emplace_back(at(0, 0, k), at(1, 0, k), at(1, 0, k - 1));
  return out;
}

TEST(CoarseMesh, HasFewerTrianglesNearbyAndKeepsTheSidesOfASheetApart) {
  const Sheet sheet = thin_sheet(40);
  const float reach = 0.012f;
  const std::vector<std::uint32_t> standing =
      standing_for(sheet.positions, sheet.normals, sheet.triangles, reach);
  for (std::size_t v = 0; v < standing.size(); ++v) {
    const std::uint32_t r = standing[v];
    EXPECT_EQ(standing[r], r);
    EXPECT_LE((sheet.positions[v] - sheet.positions[r]).norm(), reach);
    EXPECT_GT(sheet.normals[v].dot(sheet.normals[r]), 0) << "another side";
  }
  const std::vector<Triangle32> coarse = coarse_triangles(sheet.triangles, standing);
  EXPECT_LT(10 * coarse.size(), sheet.triangles.size());
  EXPECT_GT(coarse.size(), 20u);
}

// In a pose, with the parts that the fine one has: a coarse vertex lies on one of the fine mesh.
TEST(CoarseScene, HasTheSamePartsInTheSamePlacesOverFewerVertices) {
  const Anatomy a = arm();
  SceneModel model = make_scene_model(a, arm_skin);
  model.coarse = make_coarse(a, model, 0.02);
  const PosedAnatomy posed = posed_arm(a, 0.8);
  Appearance all, without;
  without.hidden = {kFirstBonePart};
  Scene fine, coarse;
  update_scene(model, posed, nullptr, {}, all, 1, fine);
  update_scene(*model.coarse, posed, nullptr, {}, all, 2, coarse);
  const DrawMesh &muscles = fine.list.meshes[1], &fewer = coarse.list.meshes[1];
  EXPECT_LT(2 * fewer.triangles.size(), muscles.triangles.size());
  EXPECT_GT(fewer.triangles.size(), 20u);
  std::vector<std::pair<Vec3f, std::uint32_t>> bones;  // of the fine scene, and their parts
  for (const DrawItem& item : fine.list.items)
    if (part_of(item.part).kind == Part::Kind::bone)
      for (const Vec3f& p : fine.list.meshes[std::size_t(item.mesh)].positions)
        bones.emplace_back((item.X_WM * p.homogeneous()).head<3>(), item.part);
  ASSERT_FALSE(bones.empty());
  const auto is_there = [](const Vec3f& place, const auto& all_places, const auto& where) {
    return std::ranges::any_of(
        all_places, [&](const auto& one) { return (where(one) - place).norm() < 1e-6f; });
  };
  for (const Vec3f& p : fewer.positions)
    EXPECT_TRUE(is_there(p, muscles.positions, [](const Vec3f& q) { return q; })) << p.transpose();
  const DrawMesh& together = coarse.list.meshes[3];
  ASSERT_EQ(together.parts.size(), together.positions.size());
  for (std::size_t v = 0; v < together.positions.size(); ++v)
    EXPECT_TRUE(is_there(together.positions[v], bones, [&](const auto& bone) {
      return bone.second == together.parts[v] ? bone.first : Vec3f(9, 9, 9);
    })) << v;
  const std::size_t before = together.triangles.size();
  update_scene(*model.coarse, posed, nullptr, {}, without, 3, coarse);
  EXPECT_LT(coarse.list.meshes[3].triangles.size(), before) << "a hidden bone";
  EXPECT_GT(coarse.list.meshes[3].triangles.size(), 0u) << "the other bone";
  EXPECT_EQ(coarse.list.meshes[1].triangles.size(), fewer.triangles.size());
}

TEST(SceneMeshes, ThoseAlikeAreTakenOverAndOthersAreNot) {
  SceneOptions first, second;
  first.key = fresh_scene_key();
  second.key = fresh_scene_key();
  const SceneModel before = make_scene_model(arm(), box({-1, -1, -1}, {1, 1, 1}), first);
  Anatomy other = arm();
  ASSERT_GE(other.bones.size(), 2u);
  other.bones[1].mesh.V *= 1.1;
  SceneModel after = make_scene_model(other, box({-1, -1, -1}, {1, 1, 1}), second);
  keep_alike(before, after);
  EXPECT_EQ(after.bones[0].key, before.bones[0].key);
  EXPECT_NE(after.bones[1].key, before.bones[1].key) << "another shape";
  EXPECT_EQ(after.skin.key, before.skin.key);
}

}  // namespace
}  // namespace ecorche
