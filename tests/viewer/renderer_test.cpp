// Laws of pictures: what is drawn is where it should be, in its colour, under its number, the same
// each time.
#include "viewer/gl/renderer.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "anatomy/errors.h"
#include "tests/viewer/balls.h"
#include "viewer/camera.h"
#include "viewer/gl/gl_probe.h"

namespace ecorche {
namespace {

DrawList red_ball() {
  DrawList list;
  list.meshes.push_back(sphere(24));
  list.items.push_back(ball({0.9f, 0.1f, 0.1f}, 7));
  list.camera = orbit_camera(Vec3f::Zero(), 1.5f, 0.3f, 0.2f);
  return list;
}

// One renderer for all tests: making a context costs more than drawing.
class RendererTest : public testing::Test {
 protected:
  static Renderer* renderer() {
    static std::optional<Renderer> one;
    static std::string reason;
    if (!one && reason.empty()) {
      try {
        one.emplace();
      } catch (const OutputError& error) {
        reason = error.what();
      }
    }
    return one ? &*one : nullptr;
  }
  void SetUp() override {
    if (!renderer()) GTEST_SKIP() << "no OpenGL on this machine";
  }
};

bool is_red(const std::uint8_t* p) { return p[0] > 90 && p[0] > 2 * p[1] && p[0] > 2 * p[2]; }

TEST_F(RendererTest, a_red_ball_is_red_in_the_middle_and_the_background_is_outside) {
  const Image image = renderer()->render(red_ball(), 200, 150);
  ASSERT_EQ(image.rgba.size(), 4u * 200 * 150);
  EXPECT_TRUE(is_red(image.pixel(100, 75)));
  EXPECT_FALSE(is_red(image.pixel(3, 3)));
  EXPECT_FALSE(is_red(image.pixel(196, 146)));
}

TEST_F(RendererTest, picking_gives_the_part_that_is_in_front) {
  DrawList list = red_ball();
  list.camera = orbit_camera(Vec3f::Zero(), 3, 0, 0);
  list.items.push_back(ball({0.2f, 0.3f, 0.9f}, 11, {0, 0, 1.5f}, 0.4f));   // nearer to the eye
  list.items.push_back(ball({0.2f, 0.9f, 0.3f}, 12, {0, 0, -1.5f}, 0.4f));  // hidden
  renderer()->render(list, 160, 160);
  EXPECT_EQ(renderer()->part_at(80, 80), 11u);
  EXPECT_EQ(renderer()->part_at(80, 62), 7u);
  EXPECT_EQ(renderer()->part_at(1, 1), 0u);
  EXPECT_EQ(renderer()->part_at(-1, 5000), 0u);
  const std::vector<std::uint32_t> parts = renderer()->parts();
  EXPECT_EQ(parts[80 * 160 + 80], 11u);
  EXPECT_EQ(std::count(parts.begin(), parts.end(), 12u), 0);
}

TEST_F(RendererTest, the_picture_is_the_right_way_up) {
  DrawList list = red_ball();
  list.camera = orbit_camera(Vec3f::Zero(), 3, 0, 0);
  list.items[0] = ball({0.9f, 0.1f, 0.1f}, 1, {0.8f, 1.4f, 0},
                       0.3f);  // up and on the body's left: right in a front view
  renderer()->render(list, 160, 160);
  const std::vector<std::uint32_t> parts = renderer()->parts();
  const auto first = std::find(parts.begin(), parts.end(), 1u) - parts.begin();
  EXPECT_LT(first / 160, 80);
  EXPECT_GT(first % 160, 80);
}

TEST_F(RendererTest, the_same_list_gives_the_same_bytes) {
  const DrawList list = red_ball();
  const Image a = renderer()->render(list, 123, 77), b = renderer()->render(list, 123, 77);
  EXPECT_EQ(a.rgba, b.rgba);
  EXPECT_EQ(encode_png(a), encode_png(b));
}

TEST_F(RendererTest, the_order_of_glass_and_flesh_does_not_matter) {
  DrawList list = red_ball();
  list.items.push_back(ball({0.9f, 0.8f, 0.7f}, 2, Vec3f::Zero(), 1.3f));
  list.items[1].surface.opacity = 0.3f;
  const Image a = renderer()->render(list, 120, 120);
  EXPECT_EQ(renderer()->part_at(60, 60), 7u) << "glass is not picked";
  std::swap(list.items[0], list.items[1]);
  EXPECT_EQ(renderer()->render(list, 120, 120).rgba, a.rgba);
}

TEST_F(RendererTest, a_dissolving_surface_goes_in_its_order) {
  DrawList list = red_ball();
  list.camera = orbit_camera(Vec3f::Zero(), 1.5f, 0, 0);
  for (const Vec3f& p : list.meshes[0].positions)
    list.meshes[0].dissolve.push_back(0.5f + 0.5f * p.y());
  list.items[0].surface.dissolved = 0.5f;
  renderer()->render(list, 100, 100);
  EXPECT_EQ(renderer()->part_at(50, 30), 7u) << "the upper half stays";
  list.meshes[0].key = 5;
  list.items[0].surface.dissolved = 1;
  renderer()->render(list, 100, 100);
  EXPECT_EQ(renderer()->part_at(50, 30), 0u);
}

TEST_F(RendererTest, a_keyed_mesh_is_sent_again_when_its_revision_changes) {
  DrawList list = red_ball();
  list.meshes[0].key = 99;
  list.camera = orbit_camera(Vec3f::Zero(), 3, 0, 0);
  renderer()->render(list, 100, 100);
  EXPECT_EQ(renderer()->part_at(50, 50), 7u);
  for (Vec3f& p : list.meshes[0].positions) p.x() += 10;
  list.meshes[0].revision = 1;
  renderer()->render(list, 100, 100);
  EXPECT_EQ(renderer()->part_at(50, 50), 0u);
}

TEST_F(RendererTest, a_shadow_falls_below) {
  DrawList list = red_ball();
  list.items[0] = ball({0.9f, 0.1f, 0.1f}, 1, {0, 1.6f, 0}, 0.5f);
  list.lighting.key_direction = {0, -1, 0.001f};
  list.ground.visible = true;
  list.ground.grid = 0;
  list.focus = {0, 0.7f, 0};
  list.focus_radius = 3;
  list.camera = orbit_camera({0, 0.5f, 0}, 3, 0, 0.7f);
  const Mat4f m = projection_matrix(list.camera, 1) * view_matrix(list.camera);
  const Image image = renderer()->render(list, 200, 200);
  auto brightness = [&](const Vec3f& p) {
    const Vec4f c = m * Vec4f(p.x(), p.y(), p.z(), 1);
    return image.pixel(int(100 * (1 + c.x() / c.w())), int(100 * (1 - c.y() / c.w())))[1];
  };
  EXPECT_LT(brightness({0, 0, 0}) + 20, brightness({1.2f, 0, 0}));
}

TEST_F(RendererTest, bad_sizes_and_lists_are_refused) {
  DrawList list = red_ball();
  EXPECT_THROW(renderer()->render(list, 0, 10), UsageError);
  EXPECT_THROW(renderer()->render(list, 10, -3), UsageError);
  EXPECT_THROW(renderer()->render(list, 20000, 10), LimitError);
  EXPECT_EQ(renderer()->render(list, 1, 1).rgba.size(), 4u);
  list.meshes[0].normals.pop_back();
  EXPECT_THROW(renderer()->render(list, 10, 10), std::invalid_argument);
  list = red_ball();
  list.meshes[0].triangles.emplace_back(0, 1, 1000000);
  EXPECT_THROW(renderer()->render(list, 10, 10), std::invalid_argument);
  list = red_ball();
  list.items[0].mesh = 3;
  EXPECT_THROW(renderer()->render(list, 10, 10), std::invalid_argument);
}

TEST_F(RendererTest, an_empty_list_is_a_background) {
  EXPECT_NO_THROW(renderer()->render(DrawList{}, 31, 17));
}

TEST(RendererContext, each_way_to_a_context_draws_the_same_ball) {
  for (const char* kind : {"egl", "pbuffer", "osmesa"}) {
    setenv("ECORCHE_GL", kind, 1);
    try {
      Renderer renderer;
      EXPECT_TRUE(is_red(renderer.render(red_ball(), 64, 64).pixel(32, 32))) << renderer.driver();
    } catch (const OutputError& error) {
      EXPECT_NE(std::string(error.what()).find(kind), std::string::npos);
    }
  }
  setenv("ECORCHE_GL", "glide", 1);
  EXPECT_THROW(Renderer(), UsageError);
  unsetenv("ECORCHE_GL");
}

TEST(RendererContext, a_driver_that_crashes_or_hangs_is_a_reason_and_not_our_end) {
  EXPECT_EQ(failure_in_child([] {}), "");
  EXPECT_EQ(failure_in_child([] { throw OutputError("no screen"); }), "no screen");
  EXPECT_NE(failure_in_child([] { raise(SIGSEGV); }).find("crashes"), std::string::npos);
  EXPECT_NE(failure_in_child([] { _exit(3); }).find("ended the process"), std::string::npos);
  EXPECT_NE(failure_in_child([] { pause(); }, 0.2).find("did not answer"), std::string::npos);
}

TEST(CameraTest, named_views_and_angles) {
  EXPECT_FLOAT_EQ(view_angles("left").azimuth, std::numbers::pi_v<float> / 2);
  EXPECT_FLOAT_EQ(view_angles("180,-90").elevation, -std::numbers::pi_v<float> / 2);
  for (const char* bad : {"", "up", "1", "1,", "nan,0", "1,2,3"})
    EXPECT_THROW(view_angles(bad), UsageError) << bad;
  const Camera camera = orbit_camera({1, 2, 3}, 1, view_angles("left").azimuth, 0);
  EXPECT_GT(camera.eye.x(), 2);  // the body's left is +X
  EXPECT_NEAR(camera.eye.z(), 3, 1e-5);
}

TEST(CameraTest, the_ball_that_was_asked_for_is_in_the_picture_from_every_side) {
  for (const char* view : {"front", "top", "bottom", "-120,33"}) {
    const ViewAngles angles = view_angles(view);
    const Camera camera =
        orbit_camera({0.2f, 1, -3}, 0.8f, angles.azimuth, angles.elevation, 0.4f, 0.5f);
    const Mat4f m = projection_matrix(camera, 0.5f) * view_matrix(camera);
    for (int k = 0; k < 6; ++k) {
      Vec3f p = camera.target;
      p[k % 3] += k < 3 ? 0.8f : -0.8f;
      const Vec4f c = m * Vec4f(p.x(), p.y(), p.z(), 1);
      EXPECT_LE(c.head<3>().cwiseAbs().maxCoeff(), c.w() * 1.0001f) << view;
    }
  }
}

}  // namespace
}  // namespace ecorche
