#include "app/stage_pictures.h"

#include <algorithm>

#include "anatomy/muscle_line.h"
#include "app/actor_film.h"
#include "viewer/camera.h"

namespace ecorche {
namespace {

constexpr float kFieldOfView = 0.3f;

void paste(const Image& part, int x, int y, Image& whole) {
  for (int row = 0; row < part.height; ++row) std::copy_n(part.pixel(0, row), 4 * static_cast<size_t>(part.width), whole.pixel(x, y + row));
}

PosedAnatomy at_rest(const Anatomy& anatomy) {
  PosedAnatomy posed;
  forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), posed.X_WJ);
  posed.slices = rest_slices(anatomy);
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) posed.lengths.push_back(strip.rest_length);
  posed.swelling.assign(posed.lengths.size(), 1);
  return posed;
}

struct Ball {
  Vec3f center;
  float radius;
};

// The box around the skin, seen as its half diagonal in the plane of a standing figure.
Ball ball_around(const Points& V) {
  const Vec3 low = V.colwise().minCoeff(), high = V.colwise().maxCoeff();
  return {(0.5 * (low + high)).cast<float>(), static_cast<float>(0.5 * (high - low).maxCoeff())};
}

void light_studio(DrawList& list) {
  list.lighting.follows_camera = true;
  list.background_top = list.background_bottom = Vec3f(1, 1, 1);
}

}  // namespace

Image picture_at_rest(Renderer& renderer, const Anatomy& anatomy, const TriMesh& skin, const Look& look, std::span<const std::string> views,
                      int width, int height) {
  const SceneModel model = make_scene_model(anatomy, skin);
  Appearance appearance;
  appearance.looks = {look};
  Scene scene;
  update_scene(model, at_rest(anatomy), nullptr, {}, appearance, 1, scene);
  light_studio(scene.list);
  const Ball ball = ball_around(skin.V);
  Image whole = make_image(width * static_cast<int>(views.size()), height);
  for (size_t i = 0; i < views.size(); ++i) {
    const ViewAngles angles = view_angles(views[i]);
    scene.list.camera = orbit_camera(ball.center, ball.radius, angles.azimuth, angles.elevation, kFieldOfView, static_cast<float>(width) / height);
    paste(renderer.render(scene.list, width, height), static_cast<int>(i) * width, 0, whole);
  }
  return whole;
}

Image picture_of_moments(Renderer& renderer, const Actor& actor, const Motion& motion, std::span<const double> seconds, int width, int height) {
  const SceneModel model = make_scene_model(actor.character.anatomy, actor.character.body.skin);
  ActorFrame frame;
  Scene scene;
  std::vector<float> activity;
  Image whole = make_image(width * static_cast<int>(seconds.size()), 2 * height);
  const float stature = 2 * ball_around(actor.character.body.skin.V).radius;
  std::uint64_t revision = 0;
  for (size_t i = 0; i < seconds.size(); ++i) {
    play(actor, pose_at(motion, seconds[i]), frame);
    muscle_shortening(model, frame.posed, activity);
    const Vec3f root = frame.posed.X_WJ[0].translation().cast<float>();
    for (int row = 0; row < 2; ++row) {
      Appearance appearance;
      appearance.looks[0].skin = row == 0 ? 1.0f : 0.0f;
      appearance.looks[0].muscles = appearance.looks[0].bones = row == 0 ? 0.0f : 1.0f;
      update_scene(model, frame.posed, &frame.skin, activity, appearance, ++revision, scene);
      light_studio(scene.list);
      scene.list.camera = orbit_camera(root, 0.47f * stature, -1.35f, 0.06f, kFieldOfView, static_cast<float>(width) / height);
      paste(renderer.render(scene.list, width, height), static_cast<int>(i) * width, row * height, whole);
    }
  }
  return whole;
}

}  // namespace ecorche
