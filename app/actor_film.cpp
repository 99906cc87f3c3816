#include "app/actor_film.h"

#include <algorithm>
#include <cmath>

#include "viewer/camera.h"

namespace ecorche {
namespace {

std::vector<Vec3> root_path(const Motion& motion, int frames, double fps) {
  std::vector<Vec3> path;
  for (int f = 0; f < frames; ++f) path.push_back(pose_at(motion, f / fps).root);
  return path;
}

std::vector<Camera> cameras_for(const ActorFilm& film, const std::vector<Vec3>& roots, double stature) {
  FollowCamera side;
  side.climb = 0.9f;  // a jump's highest point stays in the picture
  if (film.beside) {
    side.end_azimuth = -1.15f;  // not quite from the side, where one figure would hide the other
    side.distance = 6.8f;
  }
  std::vector<Camera> cameras = follow(roots, film.fps, side);
  if (film.camera == "follow") return cameras;
  const ViewAngles angles = view_angles(film.camera);
  const float aspect = static_cast<float>(film.width) / static_cast<float>(film.height);
  for (Camera& camera : cameras) {
    const Vec3f center(camera.target.x(), camera.target.y(), camera.target.z());
    camera = orbit_camera(center, 0.65f * static_cast<float>(stature), angles.azimuth, angles.elevation, 0.35f, aspect);
  }
  return cameras;
}

// Figures side by side stand across the way they go, so that neither hides the other from the camera.
Appearance appearance_of(const ActorFilm& film) {
  Appearance appearance;
  Look look;
  look.skin = film.skin ? 1.0f : 0.0f;
  look.muscles = film.muscles ? 1.0f : 0.0f;
  look.bones = film.bones ? 1.0f : 0.0f;
  if (film.skin && (film.muscles || film.bones) && !film.beside) {
    look.skin = 0.16f;  // glass, so that the layers beneath are seen
    look.skin_edge = 0.5f;
  }
  appearance.looks = {look};
  if (film.beside) {
    Look skinned = look, flayed = look;
    skinned.skin = 1;
    skinned.muscles = skinned.bones = 0;  // nothing of them is seen, and drawing them is half of a frame's time
    flayed.skin = 0;
    skinned.offset = Vec3f(0.55f, 0, 0.5f);
    flayed.offset = Vec3f(-0.55f, 0, -0.5f);
    appearance.looks = {skinned, flayed};
  }
  return appearance;
}

}  // namespace

Pose pose_at(const Motion& motion, double seconds) {
  const double last = static_cast<double>(motion.frames.size() - 1);
  const double at = std::clamp(seconds * motion.fps, 0.0, last);
  const size_t begin = static_cast<size_t>(at), end = std::min(begin + 1, motion.frames.size() - 1);
  const double share = at - static_cast<double>(begin);
  const Pose &a = motion.frames[begin], &b = motion.frames[end];
  Pose pose = a;
  pose.root = (1 - share) * a.root + share * b.root;
  for (size_t j = 0; j < pose.rotations.size(); ++j) pose.rotations[j] = a.rotations[j].slerp(share, b.rotations[j]);
  return pose;
}

FilmReport film_actor(const Actor& actor, const Motion& motion, const ActorFilm& film, const Common& common) {
  const Body& body = actor.character.body;
  const double stature = body.skin.V.col(1).maxCoeff() - body.skin.V.col(1).minCoeff();
  const int frames = std::max(1, static_cast<int>(std::lround(static_cast<double>(motion.frames.size() - 1) / motion.fps * film.fps)) + 1);
  const auto cameras = cameras_for(film, root_path(motion, frames, film.fps), stature);
  const SceneModel model = make_scene_model(actor.character.anatomy, body.skin);
  const Appearance appearance = appearance_of(film);

  FilmOptions options;
  options.output = film.output;
  options.width = film.width;
  options.height = film.height;
  options.video.fps = film.fps;
  ActorFrame frame;
  std::vector<float> activity;
  const FrameSource source = [&](int f, Scene& scene) {
    play(actor, pose_at(motion, f / film.fps), frame);
    muscle_shortening(model, frame.posed, activity);
    scene.list.camera = cameras[f];
    scene.list.ground = film.ground;
    update_scene(model, frame.posed, &frame.skin, activity, appearance, static_cast<std::uint64_t>(f) + 1, scene);
  };
  return make_film(options, frames, source, [&](int done) { progress(common, film.output.filename().string(), done, frames); });
}

}  // namespace ecorche
