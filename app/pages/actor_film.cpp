#include "app/pages/actor_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/compute/smooth_step.h"
#include "app/files/actor_look.h"
#include "app/pages/legend.h"
#include "app/progress.h"
#include "skinning/dynamics/soft_tissue.h"
#include "skinning/motion/sample_motion.h"
#include "viewer/cut_faces.h"
#include "viewer/lettering.h"
#include "viewer/organ_rooms.h"

namespace ecorche {
namespace {

constexpr double kRampSeconds = 0.15;  // from full speed to slow motion, of the motion
constexpr float kLane = 1.5f;          // m between figures side by side
constexpr float kLowestSide = 240;     // pixels; smaller pictures have no room for words

// Share of full slow motion at a moment of the motion, 0 .. 1.
double slow_share(const ActorFilm& film, double seconds) {
  if (!film.slow) return 0;
  return smooth_step((seconds - film.slow->begin) / kRampSeconds + 1) *
         smooth_step((film.slow->end - seconds) / kRampSeconds + 1);
}

// Moments of the motion at the film's frames.
std::vector<double> shown_moments(const Motion& motion, const ActorFilm& film) {
  if (film.frames) return moments_of(*film.frames, motion);
  const Span span = span_within(film.from, film.to, motion);
  std::vector<double> moments;
  double at = span.begin;
  while (at <= span.end + 1e-9) {
    moments.push_back(at);
    const double slowness = 1 + (std::max(film.slowness, 1.0) - 1) * slow_share(film, at);
    at =
        film.slow ? at + 1 / (film.fps * slowness) : span.begin + double(moments.size()) / film.fps;
  }
  return moments;
}

// Looks for the skin before the dissolve and the écorché after it; hidden layers are left out.
void dissolve(const Span& when, double seconds, Look& look) {
  const Look bare = look;
  look.skin = 1;
  look.skin_edge = 0;
  look.skin_dissolved =
      float(std::clamp((seconds - when.begin) / std::max(when.end - when.begin, 1e-6), 0.0, 1.0));
  if (look.skin_dissolved <= 0) look.muscles = look.bones = 0;
  if (look.skin_dissolved >= 1) look = bare, look.skin = look.skin_edge = 0;
}

// Figures side by side run in lanes of their own.
Appearance appearance_of(const ActorFilm& film) {
  Appearance appearance;
  appearance.muscle_colors = film.muscle_colors;
  appearance.hidden = film.hidden;
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
    // nothing of them is seen, and drawing them is half of a frame's time
    skinned.muscles = skinned.bones = 0;
    flayed.skin = 0;
    skinned.offset = Vec3f(0.5f * kLane, 0, 0);
    flayed.offset = Vec3f(-0.5f * kLane, 0, 0);
    appearance.looks = {flayed, skinned};
  }
  return appearance;
}

// A sports ground on a bright day, or the same light before a plain colour; a still before one has
// a studio's, so that no side lies in the dark.
void light(const ActorFilm& film, bool still, DrawList& list) {
  list.ground = film.ground;
  list.background_top = film.background.value_or(Vec3f(0.50f, 0.64f, 0.78f));
  list.background_bottom = film.background.value_or(Vec3f(0.90f, 0.93f, 0.94f));
  list.lighting.key_strength = 1.5f;
  list.lighting.ambient_strength = 0.5f;
  if (still && !film.ground.visible)
    light_from_camera(list.lighting.ambient_strength, list.lighting);
}

void write_words(const ActorFilm& film, double seconds, Image& picture) {
  if (std::min(picture.width, picture.height) < kLowestSide) return;
  const float size = 0.026f * float(picture.height), edge = 1.4f * size;
  if (film.legend && film.muscles)
    draw_muscle_legend(picture, edge, edge, size, film.muscle_colors);
  const float slow = slow_share(film, seconds);
  if (slow > 0)
    draw_text(picture, fmt::format("slow motion: 1 / {:g}", film.slowness),
              float(picture.width) - edge, edge + size,
              {.size = size, .opacity = slow, .align = Align::right});
}

}  // namespace

FilmReport film_actor(const Actor& actor, const Motion& motion, const ActorFilm& film,
                      const Common& common) {
  const Body& body = actor.character.body;
  const std::vector<double> moments = shown_moments(motion, film);
  const int frames = moments.size();
  const Appearance whole = appearance_of(film);
  const float aspect = float(film.width) / float(film.height);
  const auto cameras =
      film_cameras(common.assets, actor, motion, moments, whole.looks, film.view, film.fps, aspect);
  SceneOptions scene_options;
  scene_options.surface.rows_between = 1;
  scene_options.eyes = actor_eyes(common.assets, actor);
  SceneModel model = make_scene_model(actor.character.anatomy, body.skin, scene_options);
  if (actor.method == SkinMethod::ecorche) model.skin.colors = vein_colors(actor, whole.skin_color);

  FilmOptions options;
  options.output = film.output;
  options.width = film.width;
  options.height = film.height;
  options.video.fps = film.fps;
  options.render.transparent = film.transparent;
  if (film.frames)
    options.first_number = film.frames->first, options.number_step = film.frames->step;
  options.finish = [&](int f, Image& picture) { write_words(film, moments[f], picture); };
  ActorState frame(actor);
  std::vector<float> activity;
  std::vector<double> efforts;
  Appearance appearance;
  const SoftTissueTables flesh = film.dynamics ? make_soft_tissue(actor) : SoftTissueTables{};
  SoftTissueState state;
  Pose pose;
  std::vector<OrganRoom> rooms;
  if (film.section.kind != SectionPlane::Kind::none)
    rooms = find_organ_rooms(actor.character.anatomy, model.surface);
  const FrameSource source = [&](int f, Scene& scene) {
    activation_at(film.activations, moments[f], efforts);
    if (!flesh.vertices.empty())
      seek_soft_tissue(flesh, actor.character.anatomy.skeleton, motion, film.activations,
                       moments[f], state);
    pose_at(motion, moments[f], pose);
    evaluate(actor, pose, {efforts, state.offsets}, frame);
    if (film.muscle_colors == MuscleColors::activation)
      activity.assign(efforts.begin(), efforts.end());
    else
      muscle_shortening(model, frame.posed, activity);
    scene.list.camera = cameras[f];
    light(film, frames == 1, scene.list);
    appearance = whole;
    if (film.dissolve) dissolve(*film.dissolve, moments[f], appearance.looks.front());
    update_scene(model, frame.posed, &frame.skin, activity, appearance, std::uint64_t(f) + 1,
                 scene);
    if (film.section.kind == SectionPlane::Kind::none) return;
    const Vec4f plane = plane_of(film.section, actor.character.anatomy.skeleton, frame.posed);
    const auto left_free = posed_rooms(rooms, model.joint_rest, frame.posed);
    add_cut(plane, cut_faces(plane, scene.list, left_free), scene.list);
  };
  Progress progress(common, film.output.filename().string(), frames);
  return make_film(options, frames, source, [&](int done) { progress.at(done); });
}

}  // namespace ecorche
