#include "app/pages/actor_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "anatomy/compute/smooth_step.h"
#include "app/files/actor_look.h"
#include "app/pages/legend.h"
#include "app/progress.h"
#include "skinning/dynamics/soft_tissue.h"
#include "skinning/motion/sample_motion.h"
#include "viewer/cut_faces.h"
#include "viewer/lettering.h"
#include "viewer/organ_rooms.h"
#include "viewer/plate_labels.h"

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

void write_names(const ActorFilm& film, Image& picture) {
  const SecondFigure& second = *film.second;
  const float size = 0.03f * float(picture.height), width = float(picture.width);
  const bool beside = second.pairing == Pairing::beside;
  const float line = beside ? 0.5f * width : second.wipe * width;
  if (!beside) draw_line(picture, line, 0, line, float(picture.height), 2, Vec3f(1, 1, 1), 0.8f);
  draw_text(picture, second.first_name, 0.5f * line, 1.6f * size,
            {.size = size, .align = Align::center});
  draw_text(picture, second.name, 0.5f * (line + width), 1.6f * size,
            {.size = size, .align = Align::center});
}

void write_words(const ActorFilm& film, double seconds, Image& picture) {
  if (film.second) write_names(film, picture);
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

// One figure: posed at moments of its motion, into scenes.
class FilmFigure {
 public:
  FilmFigure(const Assets& assets, const Actor& actor, const Motion& motion,
             const Activations& activations, const ActorFilm& film, const Appearance& whole,
             std::uint64_t key)
      : actor_(actor),
        motion_(motion),
        activations_(activations),
        film_(film),
        whole_(whole),
        frame_(actor),
        flesh_(film.dynamics ? make_soft_tissue(actor) : SoftTissueTables{}) {
    SceneOptions options;
    options.surface.rows_between = 1;
    options.eyes = actor_eyes(assets, actor);
    options.key = key;
    model_ = make_scene_model(actor.character.anatomy, actor.character.body.skin, options);
    if (actor.method == SkinMethod::ecorche)
      model_.skin.colors = vein_colors(actor, whole.skin_color);
    if (film.section.kind != SectionPlane::Kind::none)
      rooms_ = find_organ_rooms(actor.character.anatomy, model_.surface);
  }

  void pose(double moment, bool still, std::uint64_t revision, Scene& scene) {
    activation_at(activations_, moment, efforts_);
    if (!flesh_.vertices.empty())
      seek_soft_tissue(flesh_, actor_.character.anatomy.skeleton, motion_, activations_, moment,
                       state_);
    pose_at(motion_, moment, pose_);
    evaluate(actor_, pose_, {efforts_, state_.offsets}, frame_);
    if (film_.muscle_colors == MuscleColors::activation)
      activity_.assign(efforts_.begin(), efforts_.end());
    else
      muscle_shortening(model_, frame_.posed, activity_);
    light(film_, still, scene.list);
    appearance_ = whole_;
    if (film_.dissolve) dissolve(*film_.dissolve, moment, appearance_.looks.front());
    update_scene(model_, frame_.posed, &frame_.skin, activity_, appearance_, revision, scene);
    if (film_.section.kind == SectionPlane::Kind::none) return;
    const Vec4f plane = plane_of(film_.section, actor_.character.anatomy.skeleton, frame_.posed);
    const auto left_free = posed_rooms(rooms_, model_.joint_rest, frame_.posed);
    add_cut(plane, cut_faces(plane, scene.list, left_free), scene.list);
  }

 private:
  const Actor& actor_;
  const Motion& motion_;
  const Activations& activations_;
  const ActorFilm& film_;
  Appearance whole_, appearance_;
  SceneModel model_;
  ActorState frame_;
  const SoftTissueTables flesh_;
  SoftTissueState state_;
  Pose pose_;
  std::vector<float> activity_;
  std::vector<double> efforts_;
  std::vector<OrganRoom> rooms_;
};

ShotFrames frames_of_film(const Assets& assets, const Actor& actor, const Motion& motion,
                          const ActorFilm& film, std::span<const Look> looks, float aspect) {
  if (!film.shots.empty())
    return frames_of(assets, actor, motion, film.shots, looks, film.fps, aspect);
  ShotFrames out;
  out.moments = shown_moments(motion, film);
  out.cameras =
      film_cameras(assets, actor, motion, out.moments, looks, film.view, film.fps, aspect);
  return out;
}

// Cameras of the second figure, and those of the first: beside each other from one distance, so
// that sizes compare; one over the other with one camera.
std::vector<Camera> second_cameras(const Assets& assets, const ActorFilm& film,
                                   std::span<const Look> looks, float aspect,
                                   std::vector<Camera>& first) {
  const SecondFigure& second = *film.second;
  if (second.pairing == Pairing::wiped) return first;
  std::vector<Camera> out =
      frames_of_film(assets, *second.actor, *second.motion, film, looks, aspect).cameras;
  out.resize(first.size(), out.back());
  for (std::size_t k = 0; k < first.size(); ++k) {
    const Vec3f a = first[k].eye - first[k].target, b = out[k].eye - out[k].target;
    const float distance = std::max(a.norm(), b.norm());
    first[k].eye = first[k].target + distance * a.normalized();
    out[k].eye = out[k].target + distance * b.normalized();
  }
  return out;
}

}  // namespace

FilmReport film_actor(const Actor& actor, const Motion& motion, const ActorFilm& film,
                      const Common& common) {
  const Appearance whole = appearance_of(film);
  const bool halves = film.second && film.second->pairing == Pairing::beside;
  const float aspect = float(film.width) / float(film.height) / (halves ? 2.0f : 1.0f);
  ShotFrames shots = frames_of_film(common.assets, actor, motion, film, whole.looks, aspect);
  const int frames = int(shots.moments.size());
  std::vector<Camera> cameras_beside;
  if (film.second)
    cameras_beside = second_cameras(common.assets, film, whole.looks, aspect, shots.cameras);

  FilmOptions options;
  options.output = film.output;
  options.width = film.width;
  options.height = film.height;
  options.video.fps = film.fps;
  options.render.transparent = film.transparent;
  if (film.frames)
    options.first_number = film.frames->first, options.number_step = film.frames->step;
  FilmFigure figure(common.assets, actor, motion, film.activations, film, whole, 1);
  std::optional<FilmFigure> second;
  if (film.second) {
    Appearance looks = whole;
    looks.hidden = film.second->hidden;
    options.pairing = film.second->pairing;
    options.wipe = film.second->wipe;
    second.emplace(common.assets, *film.second->actor, *film.second->motion,
                   film.second->activations, film, looks, fresh_scene_key());
  }
  // Written by the thread that poses, read once the frame is drawn.
  std::vector<std::vector<PlateLabel>> labels(std::size_t(film.labels.empty() ? 0 : frames));
  options.finish = [&](int f, Image& picture) {
    if (!labels.empty()) draw_labels(picture, labels[std::size_t(f)]);
    write_words(film, shots.moments[f], picture);
  };
  const FrameSource source = [&](int number, Scene& scene) {
    const int f = second ? number / 2 : number;
    const bool other = second && number % 2 == 1;
    scene.list.camera = (other ? cameras_beside : shots.cameras)[std::size_t(f)];
    (other ? *second : figure)
        .pose(shots.moments[f], frames == 1, std::uint64_t(number) + 1, scene);
    if (!labels.empty() && !other)
      labels[std::size_t(f)] =
          plate_labels(actor.character.anatomy, seen_places(scene.list, aspect, film.labels));
  };
  Progress progress(common, film.output.filename().string(), frames);
  return make_film(options, frames, source, [&](int done) { progress.at(done); });
}

}  // namespace ecorche
