#include "app/actor_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/smooth_step.h"
#include "app/eyes.h"
#include "app/legend.h"
#include "app/progress.h"
#include "skinning/flesh_motion.h"
#include "skinning/pose_at.h"
#include "viewer/camera.h"
#include "viewer/follow_camera.h"
#include "viewer/lettering.h"

namespace ecorche {
namespace {

constexpr double kRampSeconds = 0.15;    // from full speed to slow motion, of the motion
constexpr float kLane = 1.5f;            // m between figures side by side
constexpr float kLowestSide = 240;       // pixels; smaller pictures have no room for words

// How much of full slow motion there is at a moment of the motion.
double slow_share(const ActorFilm& film, double seconds) {
  if (!film.slow) return 0;
  return smooth_step((seconds - film.slow->begin) / kRampSeconds + 1) * smooth_step((film.slow->end - seconds) / kRampSeconds + 1);
}

// The moments of the motion that the film's frames show.
std::vector<double> moments_of(const Motion& motion, const ActorFilm& film) {
  const double end = static_cast<double>(motion.frames.size() - 1) / motion.fps;
  std::vector<double> moments;
  double at = 0;
  while (at <= end + 1e-9) {
    moments.push_back(at);
    const double slowness = 1 + (std::max(film.slowness, 1.0) - 1) * slow_share(film, at);
    at = film.slow ? at + 1 / (film.fps * slowness) : static_cast<double>(moments.size()) / film.fps;
  }
  return moments;
}

// Some of the skin of every figure in every frame, and the ground beneath it: what the camera has to keep in sight. The skin need not
// settle for that.
std::vector<std::vector<Vec3f>> figures_of(const Actor& actor, const Motion& motion, const std::vector<double>& moments, const Appearance& appearance) {
  constexpr int stride = 29;
  std::vector<std::vector<Vec3f>> figures;
  ActorFrame frame;
  const SkinMethod method = actor.method == SkinMethod::ecorche ? SkinMethod::anchors : actor.method;
  Pose pose;
  for (const double at : moments) {
    pose_at(motion, at, pose);
    pose_anatomy(actor.table, actor.character.anatomy.skeleton, pose, frame.posed);
    move_skin(actor, method, frame);
    std::vector<Vec3f>& points = figures.emplace_back();
    const Vec3f root = frame.posed.X_WJ.front().translation().cast<float>();
    for (const Look& look : appearance.looks) {
      points.emplace_back(root.x() + look.offset.x(), 0, root.z() + look.offset.z());
      for (std::size_t i = 0; i + 3 < frame.skin.positions.size(); i += 4 * stride)
        points.emplace_back(Vec3f(frame.skin.positions[i], frame.skin.positions[i + 1], frame.skin.positions[i + 2]) + look.offset);
    }
  }
  return figures;
}

std::vector<Camera> cameras_for(const ActorFilm& film, const std::vector<std::vector<Vec3f>>& figures, double stature) {
  FollowCamera side;
  side.fov_y = 0.30f;
  side.smoothing = 0.22;
  side.aspect = static_cast<float>(film.width) / static_cast<float>(film.height);
  if (film.beside) {  // from before and beside them, where neither figure hides the other
    side.begin_azimuth = -0.62f;
    side.end_azimuth = -0.95f;
  }
  const bool follows = film.camera == "follow";
  if (!follows) side.begin_azimuth = side.end_azimuth = view_angles(film.camera).azimuth;
  std::vector<Camera> cameras = follow(figures, film.fps, side);
  if (follows) return cameras;
  const ViewAngles angles = view_angles(film.camera);
  const float radius = (film.beside ? 0.85f : 0.65f) * static_cast<float>(stature);
  for (Camera& camera : cameras) camera = orbit_camera(camera.target, radius, angles.azimuth, angles.elevation, 0.35f, side.aspect);
  return cameras;
}

// Skin before the dissolve, écorché after it; nothing that is hidden is drawn.
void dissolve(const Span& when, double seconds, Look& look) {
  const Look bare = look;
  look.skin = 1;
  look.skin_edge = 0;
  look.skin_dissolved = static_cast<float>(std::clamp((seconds - when.begin) / std::max(when.end - when.begin, 1e-6), 0.0, 1.0));
  if (look.skin_dissolved <= 0) look.muscles = look.bones = 0;
  if (look.skin_dissolved >= 1) look = bare, look.skin = look.skin_edge = 0;
}

// Figures side by side run in lanes of their own.
Appearance appearance_of(const ActorFilm& film) {
  Appearance appearance;
  appearance.muscle_colors = film.muscle_colors;
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
    skinned.offset = Vec3f(0.5f * kLane, 0, 0);
    flayed.offset = Vec3f(-0.5f * kLane, 0, 0);
    appearance.looks = {flayed, skinned};
  }
  return appearance;
}

// A sports ground on a bright day.
void light_outdoors(const ActorFilm& film, DrawList& list) {
  list.ground = film.ground;
  list.background_top = Vec3f(0.50f, 0.64f, 0.78f);
  list.background_bottom = Vec3f(0.90f, 0.93f, 0.94f);
  list.lighting.key_strength = 1.5f;
  list.lighting.ambient_strength = 0.5f;
}

void write_words(const ActorFilm& film, double seconds, Image& picture) {
  if (std::min(picture.width, picture.height) < kLowestSide) return;
  const float size = 0.026f * static_cast<float>(picture.height), edge = 1.4f * size;
  if (film.legend && film.muscles) draw_muscle_legend(picture, edge, edge, size, film.muscle_colors);
  const auto slow = static_cast<float>(slow_share(film, seconds));
  if (slow > 0)
    draw_text(picture, fmt::format("slow motion: 1 / {:g}", film.slowness), static_cast<float>(picture.width) - edge, edge + size,
              {.size = size, .opacity = slow, .align = Align::right});
}

}  // namespace

FilmReport film_actor(const Actor& actor, const Motion& motion, const ActorFilm& film, const Common& common) {
  const Body& body = actor.character.body;
  const double stature = body.skin.V.col(1).maxCoeff() - body.skin.V.col(1).minCoeff();
  const std::vector<double> moments = moments_of(motion, film);
  const int frames = static_cast<int>(moments.size());
  const Appearance whole = appearance_of(film);
  const auto cameras = cameras_for(film, figures_of(actor, motion, moments, whole), stature);
  SceneOptions scene_options;
  scene_options.eyes = find_eyes(body.skin, actor.character.anatomy.skeleton);
  const SceneModel model = make_scene_model(actor.character.anatomy, body.skin, scene_options);

  FilmOptions options;
  options.output = film.output;
  options.width = film.width;
  options.height = film.height;
  options.video.fps = film.fps;
  options.finish = [&](int f, Image& picture) { write_words(film, moments[f], picture); };
  ActorFrame frame;
  std::vector<float> activity;
  std::vector<double> efforts;
  Appearance appearance;
  const FleshTables flesh = film.dynamics ? make_flesh_tables(actor.binding, actor.character.anatomy) : FleshTables{};
  FleshState state;
  Pose pose;
  const FrameSource source = [&](int f, Scene& scene) {
    activation_at(film.activations, moments[f], efforts);
    if (!flesh.vertices.empty()) move_flesh(flesh, actor.character.anatomy.skeleton, motion, film.activations, moments[f], state);
    pose_at(motion, moments[f], pose);
    play(actor, pose, frame, efforts, state.seen);
    muscle_shortening(model, frame.posed, activity);
    scene.list.camera = cameras[f];
    light_outdoors(film, scene.list);
    appearance = whole;
    if (film.dissolve) dissolve(*film.dissolve, moments[f], appearance.looks.front());
    update_scene(model, frame.posed, &frame.skin, activity, appearance, static_cast<std::uint64_t>(f) + 1, scene);
  };
  Progress progress(common, film.output.filename().string(), frames);
  return make_film(options, frames, source, [&](int done) { progress.at(done); });
}

}  // namespace ecorche
