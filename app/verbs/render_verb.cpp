#include "app/verbs/render_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/files/actor.h"
#include "app/files/open_character.h"
#include "app/files/open_motion.h"
#include "app/options/activation_options.h"
#include "app/options/motion_options.h"
#include "app/options/option_values.h"
#include "app/options/picture_size.h"
#include "app/options/subject_options.h"
#include "app/pages/actor_film.h"
#include "skinning/motion/pose_table.h"
#include "viewer/camera.h"
#include "viewer/part_names.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct RenderVerbOptions {
  fs::path character, motion, weights, poses;
  std::string activation = "none", layers = "skin,muscles,bones", size = "1280x720",
              skin = "ecorche", muscles = "auto";
  std::string frames, hide, only, pose, section, background = "outdoors";
  std::optional<std::string> camera;
  std::optional<double> at, definition;
  std::vector<double> dissolve;
  std::string colour = "flesh";
  MotionOptions retarget;
  ActorFilm film;
};

void set_layers(const std::string& text, ActorFilm& film) {
  film.skin = film.muscles = film.bones = false;
  std::istringstream names(text);
  for (std::string name; std::getline(names, name, ',');) {
    if (name == "skin")
      film.skin = true;
    else if (name == "muscles")
      film.muscles = true;
    else if (name == "bones")
      film.bones = true;
    else
      throw UsageError(
          fmt::format("--layers: '{}' is no layer; there are skin, muscles and bones", name));
  }
  if (!film.skin && !film.muscles && !film.bones)
    throw UsageError("--layers: none is named; there are skin, muscles and bones");
}

void set_colour(const RenderVerbOptions& options, ActorFilm& film) {
  film.muscle_colors = options.colour == "length"       ? MuscleColors::shortening
                       : options.colour == "activation" ? MuscleColors::activation
                                                        : MuscleColors::flesh;
  if (options.colour == "activation" && options.activation == "none")
    throw UsageError("--colour activation: no muscle works; say --activation auto, or a table");
}

void set_background(const std::string& text, ActorFilm& film) {
  film.ground.visible = text == "outdoors";
  film.transparent = text == "transparent";
  if (film.ground.visible || film.transparent) return;
  unsigned red = 255, green = 255, blue = 255;
  char trailing = 0;
  const bool good =
      text == "white" || (text.size() == 7 && std::sscanf(text.c_str(), "#%2x%2x%2x%c", &red,
                                                          &green, &blue, &trailing) == 3);
  if (!good)
    throw UsageError(fmt::format(
        "--background: '{}': expected outdoors, white, transparent, or a colour #RRGGBB", text));
  film.background = Eigen::Vector3i(int(red), int(green), int(blue)).cast<float>() / 255;
}

// Parts that are not drawn: those of --hide, or all but those of --only.
std::vector<std::uint32_t> hidden_parts(const RenderVerbOptions& options, const Anatomy& anatomy) {
  std::vector<std::uint32_t> hidden = parts_of_list(anatomy, options.hide, "--hide");
  if (options.only.empty()) return hidden;
  const std::vector<std::uint32_t> only = parts_of_list(anatomy, options.only, "--only");
  for (const std::uint32_t part : all_parts(anatomy))
    if (!std::ranges::binary_search(only, part)) hidden.push_back(part);
  std::sort(hidden.begin(), hidden.end());
  hidden.erase(std::unique(hidden.begin(), hidden.end()), hidden.end());
  return hidden;
}

// Checks options before any file is read.
void check_options_render(const RenderVerbOptions& options) {
  const ActorFilm& film = options.film;
  const bool still =
      film.output.extension() == ".png" && film.output.string().find('%') == std::string::npos;
  const bool part = film.from || film.to || !options.frames.empty();
  if (options.motion.empty() && !still)
    throw UsageError(
        fmt::format("{}: a film needs a motion; one picture at rest or in a --pose is named "
                    "like STILL.png",
                    film.output.string()));
  if (options.motion.empty() && (part || options.at))
    throw UsageError("--at, --from, --to and --frames mean moments of a motion; name one");
  if (!options.motion.empty() && !options.pose.empty())
    throw UsageError("--pose: leave the motion away, or choose its moment with --at");
  if (!options.motion.empty() && still && !options.at)
    throw UsageError(
        fmt::format("{}: which moment of the motion? Say --at SECONDS", film.output.string()));
  if (options.at && !still)
    throw UsageError(
        "--at: one moment is one picture; name it like STILL.png, or give --from and --to");
  if (options.at && part) throw UsageError("--at excludes --from, --to and --frames");
  if (film.beside && !film.view.look_at.empty())
    throw UsageError("--look-at: one figure can be seen closely; leave --beside away");
  if (film.dynamics && options.motion.empty())
    throw UsageError("--dynamics: flesh lags in a motion; name one");
  if (!options.poses.empty() && options.pose.empty())
    throw UsageError("--poses: name one of its poses with --pose");
}

struct Posture {
  Pose pose;
  std::string view;  // from where it is best seen
};

// A pose of the pose book, or one at the joint limits.
Posture find_posture(const fs::path& tables, const RenderVerbOptions& options,
                     const Skeleton& skeleton) {
  std::vector<std::string> known;
  const fs::path book = options.poses.empty() ? tables / "poses" / "poses.csv" : options.poses;
  for (NamedPose& each : read_pose_table(book, skeleton)) {
    if (each.name == options.pose) return {std::move(each.pose), each.view};
    known.push_back(each.name);
  }
  if (options.poses.empty())
    for (LimitPose& each : standard_limit_poses(tables, skeleton)) {
      if (each.name == options.pose) return {std::move(each.pose), "oblique"};
      known.push_back(each.name);
    }
  const std::string near = nearest_name(options.pose, known);
  throw UsageError(fmt::format(
      "--pose: no pose is called '{}'{}; look into {}{}", options.pose,
      near.empty() ? "" : fmt::format(": did you mean '{}'?", near), book.string(),
      options.poses.empty() ? fmt::format(" and {}", (tables / "poses.csv").string()) : ""));
}

// One frame: at rest, or in the pose, its lowest point on the ground as at rest.
Motion still_motion(const Actor& actor, const std::optional<Posture>& posture) {
  Motion motion;
  motion.frames.push_back(rest_pose(actor.character.anatomy.skeleton));
  if (!posture) return motion;
  Pose& pose = motion.frames.front();
  pose = posture->pose;
  ActorState frame(actor);
  evaluate_skin(actor, pose, {}, frame);
  Points skin;
  to_points(frame.skin, skin);
  pose.root.y() += actor.character.body.skin.V.col(1).minCoeff() - skin.col(1).minCoeff();
  return motion;
}

// What is shown of the character and from where, before it is compiled, which takes seconds.
std::optional<Posture> choose_view(const Assets& assets, const RenderVerbOptions& options,
                                   const Character& character, ActorFilm& film) {
  const Skeleton& skeleton = character.anatomy.skeleton;
  film.hidden = hidden_parts(options, character.anatomy);
  if (!options.section.empty())
    film.section = read_section_plane(options.section, skeleton, "--section");
  std::optional<Posture> posture;
  if (!options.pose.empty()) posture = find_posture(assets.tables, options, skeleton);
  const std::string view = !options.motion.empty() || !film.view.look_at.empty() ? "follow"
                           : posture                                             ? posture->view
                                                                                 : "oblique";
  film.view.camera = options.camera.value_or(view);
  check_view(assets, character, film.view);
  return posture;
}

int run_render(RenderVerbOptions options, const Common& common, Report& report) {
  ActorFilm& film = options.film;
  set_layers(options.layers, film);
  require_picture_size(options.size, film.width, film.height);
  set_background(options.background, film);
  check_options_render(options);
  if (options.dissolve.size() == 2) film.dissolve = Span{options.dissolve[0], options.dissolve[1]};
  set_colour(options, film);
  if (!options.frames.empty()) film.frames = read_frame_range(options.frames, "--frames");
  if (options.at) film.from = film.to = options.at;
  const bool numbered = film.output.string().find('%') != std::string::npos;
  check_outputs(common, numbered ? std::vector<fs::path>() : std::vector{film.output},
                {options.character, options.motion, options.weights, options.activation,
                 options.poses, options.retarget.map_file});
  require_settling(film.dynamics, options.skin);
  // A fine skin with relief takes as long as all the rest: only where it is seen.
  const bool skin_shown = film.skin || film.dissolve;
  const std::optional<double> definition = to_definition(options.definition, options.skin);
  const ActorOptions how{.weights = options.weights,
                         .muscles = to_muscle_motion(options.muscles, options.skin),
                         .definition = skin_shown ? definition : 0,
                         .refinement = skin_shown};
  Character character = open_character(options.character, common, report);
  const std::optional<Posture> posture = choose_view(common.assets, options, character, film);
  Activations table = read_activation_table(common.assets, options.activation, character.anatomy);
  auto [actor, motion] =
      options.motion.empty()
          ? MovedActor{make_actor(common.assets, std::move(character), report, how), Motion{}}
          : open_moved_actor(options.motion, std::move(character), how, options.retarget, common,
                             report);
  choose_skin(common.assets, actor, options.skin);
  if (options.motion.empty()) motion = still_motion(actor, posture);
  film.legend =
      film.legend && !(options.motion.empty() && options.pose.empty()) && !film.transparent;
  film.activations = open_activations(options.activation, std::move(table), actor, motion, report);
  const FilmReport done = film_actor(actor, motion, film, common);
  report.set("timings_ms.film", 1e3 * done.seconds);
  report.set("film.frames", done.frames);
  report.set("film.driver", done.driver);
  note(common,
       fmt::format("{}: {} {} of {}x{} in {:.1f} s", film.output.string(), done.frames,
                   done.frames == 1 ? "frame" : "frames", done.width, done.height, done.seconds));
  return 0;
}

void add_view_options(CLI::App& verb, RenderVerbOptions& options) {
  verb.add_option("--camera", options.camera,
                  fmt::format("follow; or {}. When left out: follow; of a close-up, from where the "
                              "part is seen best; of a still, as the pose is seen best",
                              view_names()));
  verb.add_option("--look-at", options.film.view.look_at,
                  "Close-up of a bone, muscle, region of muscles, joint, or landmark of the skin, "
                  "which stays in the middle");
  CLI::Option* zoom = verb.add_option("--zoom", options.film.view.zoom, "Times as large")
                          ->check(between(0.05, 100.0))
                          ->capture_default_str();
  verb.add_option("--distance", options.film.view.distance,
                  "Metres from the eye to what is looked at")
      ->check(between(0.02, 1000.0))
      ->excludes(zoom);
  verb.add_option("--layers", options.layers,
                  "What is seen: skin, muscles, bones; the skin is glass over other layers")
      ->capture_default_str();
  CLI::Option* hide =
      verb.add_option("--hide", options.hide,
                      "Parts to leave away: names of bones, muscles, regions (thigh, trunk_back, "
                      "...), layers (superficial, ...), with commas between them; * stands for any "
                      "letters, a name without side for both");
  verb.add_option("--only", options.only, "The only parts to show, named likewise")->excludes(hide);
  verb.add_option("--section", options.section,
                  "Cut by a plane, what lies before it taken away, as a scan's slice: "
                  "transverse:HEIGHT, frontal:BEFORE or sagittal:LEFT of the pelvis, or "
                  "JOINT-JOINT:SHARE, square to the line between two joints (transverse:95cm, "
                  "hip_l-knee_l:50%)");
  verb.add_option("--background", options.background,
                  "outdoors; white, a colour #RRGGBB, or, for pictures, transparent")
      ->capture_default_str();
}

void add_moment_options(CLI::App& verb, RenderVerbOptions& options) {
  verb.add_option("--at", options.at, "A still: this moment of the motion, in seconds")
      ->check(between(0.0, 1e5));
  verb.add_option("--pose", options.pose,
                  "A still without motion: a pose of data/poses/poses.csv or data/poses.csv; at "
                  "rest when left out");
  verb.add_option(
      "--poses", options.poses,
      "Table of poses like data/poses/poses.csv or data/poses.csv that --pose is looked up "
      "in");
  CLI::Option* from = verb.add_option("--from", options.film.from,
                                      "Where the film begins, in seconds of the motion")
                          ->check(between(0.0, 1e5));
  CLI::Option* to =
      verb.add_option("--to", options.film.to, "Where it ends")->check(between(0.0, 1e5));
  verb.add_option("--frames", options.frames,
                  "Frames of the motion, counted from 1, one a picture: 1-240; x2 behind it takes "
                  "every second one. Pictures are numbered as the frames are")
      ->excludes(from)
      ->excludes(to);
}

}  // namespace

void add_render_verb(VerbRegistry& registry) {
  auto options = std::make_shared<RenderVerbOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "render", "Film a character's motion, or take a picture of it",
      "ecorche render anna-anatomy.glb walk.bvh -o anna.mp4 --layers muscles,bones --camera left\n"
      "  ecorche render anna-anatomy.glb walk.bvh -o knee.png --at 1.2 --look-at knee_l --hide "
      "skin\n"
      "  ecorche render anna-anatomy.glb -o squat.png --pose squat --background white\n"
      "  ecorche render anna-anatomy.glb -o slice.png --section hip_l-knee_l:50% --camera top "
      "--look-at hip_l --background white",
      [options](const Common& common, Report& report) {
        return run_render(*options, common, report);
      });
  add_character_option(*verb, options->character);
  verb->add_option(
      "motion", options->motion,
      std::string(kMotionFilesHelp) + "; left away for a still at rest or in a --pose");
  verb->add_option("-o,--output", options->film.output,
                   "FILM.mp4, numbered pictures DIR/%04d.png, or one picture STILL.png")
      ->required();
  add_view_options(*verb, *options);
  add_moment_options(*verb, *options);
  add_skin_option(*verb, options->skin);
  add_weights_option(*verb, options->weights);
  add_muscles_option(*verb, options->muscles);
  verb->add_flag("--beside", options->film.beside, "The skin, and the figure without it beside it");
  verb->add_option(
          "--dissolve", options->dissolve,
          "The skin goes, from the feet up, between these two moments of the motion, in seconds")
      ->expected(2)
      ->delimiter(',')
      ->check(between(0.0, 1e5));
  CLI::Option* colour =
      verb->add_option(
              "--colour", options->colour,
              "What muscles' colours say: flesh; length (yellow shorter, blue longer, told "
              "apart by colour-blind eyes); activation (pale relaxed, dark red full effort)")
          ->check(CLI::IsMember({"flesh", "length", "activation"}))
          ->capture_default_str();
  verb->add_flag_callback(
          "--colour-map", [options] { options->colour = "length"; }, "--colour length")
      ->excludes(colour);
  verb->add_flag("!--no-legend", options->film.legend, "Leave away what the muscles' colours mean");
  verb->add_option("--size", options->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  verb->add_option("--fps", options->film.fps, "Frames a second")
      ->check(between(1.0, 240.0))
      ->capture_default_str();
  add_activation_option(*verb, options->activation);
  add_dynamics_option(*verb, options->film.dynamics);
  add_definition_option(*verb, options->definition);
  add_motion_options(*verb, options->retarget);
}

}  // namespace ecorche
