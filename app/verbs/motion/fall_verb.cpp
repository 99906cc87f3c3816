#include "app/verbs/motion/fall_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/errors.h"
#include "app/files/actor.h"
#include "app/files/open_character.h"
#include "app/files/open_motion.h"
#include "app/options/motion_options.h"
#include "app/options/option_values.h"
#include "app/options/picture_size.h"
#include "app/options/subject_options.h"
#include "app/pages/actor_film.h"
#include "app/progress.h"
#include "app/ragdoll/character_ragdoll.h"
#include "app/verbs/motion/write_motion.h"
#include "skinning/motion/pose_book.h"
#include "skinning/motion/sample_motion.h"
#include "skinning/ragdoll/fall.h"
#include "skinning/ragdoll/moving_body.h"
#include "viewer/part_names.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct FallVerbOptions {
  fs::path character;
  std::vector<fs::path> outputs;
  std::string from = "standing", size = "1280x720", camera = "oblique";
  double at = 0, height = 0;
  std::vector<double> push{0.2, 0, 0.4};  // m/s, as one sways
  MotionOptions read;
  FallOptions fall;
};

bool is_film(const fs::path& output) {
  return output.extension() == ".mp4" || output.extension() == ".png";
}

bool is_numbered(const fs::path& output) { return output.string().find('%') != std::string::npos; }

bool names_file(const std::string& from) { return fs::path(from).has_extension(); }

Pose pose_named(const fs::path& tables, const std::string& name, const Skeleton& skeleton) {
  const fs::path book = tables / "poses" / "poses.csv";
  std::vector<std::string> known;
  for (NamedPose& each : read_pose_book(book, skeleton)) {
    if (each.name == name) return std::move(each.pose);
    known.push_back(each.name);
  }
  const std::string near = nearest_name(name, known);
  throw UsageError(
      fmt::format("--from: no pose is called '{}'{}; look into {}, or name a motion file", name,
                  near.empty() ? "" : fmt::format(": did you mean '{}'?", near), book.string()));
}

// The skin is made ready for pictures where one is asked for.
struct FallenCharacter {
  std::optional<Actor> actor;
  std::optional<BoundCharacter> bound;

  const Character& character() const { return actor ? actor->character : bound->character; }
  const Binding& binding() const { return actor ? actor->binding : bound->binding; }
};

FallenCharacter open_fallen(const FallVerbOptions& options, const Common& common, Report& report) {
  Character character = open_character(options.character, common, report);
  FallenCharacter out;
  if (std::ranges::any_of(options.outputs, is_film))
    out.actor =
        make_actor(common.assets, std::move(character), report, {.muscles = MuscleMotion::lines});
  else
    out.bound = bind_character(common.assets, std::move(character), report);
  return out;
}

// What goes before the fall at its frame rate, and the body as it is let go.
struct FallBeginning {
  std::vector<Pose> before;
  BodyState body;
};

FallBeginning begin_fall(const FallVerbOptions& options, const FallenCharacter& person,
                         const Ragdoll& ragdoll, const Common& common, Report& report) {
  const Skeleton& skeleton = person.character().anatomy.skeleton;
  FallBeginning out;
  if (!names_file(options.from)) {
    out.body.pose = pose_named(common.assets.tables, options.from, skeleton);
    complete_pose(skeleton, out.body.pose);
    put_at_height(ragdoll, options.fall.world.ground_height + options.height, out.body.pose);
    return out;
  }
  const Motion motion =
      open_motion(options.from, person.character(), person.binding(), options.read, common, report);
  const double last = double(motion.frames.size() - 1) / motion.fps;
  if (options.at > last)
    throw UsageError(fmt::format("--at: {} ends after {:.4g} s", options.from, last));
  const int count = int(std::floor(options.at * options.fall.fps + 1e-9));
  for (int f = count; f > 0; --f) {
    out.before.emplace_back();
    pose_at(motion, options.at - f / options.fall.fps, out.before.back());
  }
  out.body = moving_body(ragdoll.body, motion, options.at);
  for (Pose& pose : out.before) pose.root.y() += options.height;
  out.body.pose.root.y() += options.height;
  return out;
}

void write_fall(const FallVerbOptions& options, const FallenCharacter& person, const Motion& motion,
                const Common& common) {
  const Skeleton& skeleton = person.character().anatomy.skeleton;
  for (const fs::path& output : options.outputs) {
    if (!is_film(output)) {
      write_motion(output, skeleton, motion, "fall", common);
      continue;
    }
    ActorFilm film;
    film.output = output;
    read_picture_size(options.size, film.width, film.height);
    film.fps = motion.fps;
    film.muscles = film.bones = film.legend = false;
    film.view.camera = options.camera;
    film.ground.visible = true;
    film.ground.height = float(ground_height(person.character()));
    if (output.extension() == ".png" && !is_numbered(output))
      film.from = film.to = double(motion.frames.size() - 1) / motion.fps;
    film_actor(*person.actor, motion, film, common);
    note_written(output, motion, common);
  }
}

void report_fall(const FallResult& fallen, double seconds, const Common& common, Report& report) {
  report.set("fall.weight", fallen.weight);
  report.set("fall.touch", fallen.touch);
  report.set("fall.rest", fallen.rest);
  report.set("fall.peak_force", fallen.peak_force);
  report.set("fall.end_force", fallen.end_force);
  report.set("fall.end_speed", fallen.end_speed);
  report.set("fall.limit_excess_deg", fallen.limit_excess * kDegreesPerRadian);
  if (!fallen.worst_joint.empty()) report.set("fall.worst_joint", fallen.worst_joint);
  report.set("fall.deepest", fallen.deepest);
  report.set("fall.overlap", fallen.overlap);
  report.set("fall.core_seconds", seconds);
  const std::string rest = fallen.rest >= 0
                               ? fmt::format("lies still after {:.2f} s", fallen.rest)
                               : fmt::format("still moves at {:.3f} m/s", fallen.end_speed);
  note(common,
       fmt::format(
           "{}; the ground bears up to {:.1f} weights and {:.2f} in the end; at most {:.1f} "
           "degrees beyond a limit, {:.0f} mm in the ground, {:.0f} mm of limb in limb",
           rest, fallen.peak_force / fallen.weight, fallen.end_force / fallen.weight,
           fallen.limit_excess * kDegreesPerRadian, 1e3 * fallen.deepest, 1e3 * fallen.overlap));
}

int run_fall(FallVerbOptions options, const Common& common, Report& report) {
  int width = 0, height = 0;
  for (const fs::path& output : options.outputs)
    require_ending(output, {".mp4", ".png", ".bvh", ".glb", ".fbx"});
  require_picture_size(options.size, width, height);
  if (options.at > 0 && !names_file(options.from))
    throw UsageError("--at: a moment of a motion; name its file with --from");
  std::vector<fs::path> files = options.outputs;
  std::erase_if(files, [](const fs::path& file) { return is_numbered(file); });
  check_outputs(common, files, {options.character, options.from});
  const FallenCharacter person = open_fallen(options, common, report);
  const Ragdoll ragdoll =
      character_ragdoll(options.character.string(), person.character(), person.binding(), report);
  options.fall.push = Vec3(options.push[0], options.push[1], options.push[2]);
  options.fall.world.ground_height = ground_height(person.character());
  FallBeginning beginning = begin_fall(options, person, ragdoll, common, report);
  Progress progress(common, "fall", 100);
  const auto start = std::chrono::steady_clock::now();
  FallResult fallen = fall(ragdoll, std::move(beginning.body), options.fall,
                           [&](double share) { progress.at(int(100 * share)); });
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  report_fall(fallen, seconds.count(), common, report);
  std::vector<Pose>& frames = fallen.motion.frames;
  frames.insert(frames.begin(), beginning.before.begin(), beginning.before.end());
  write_fall(options, person, fallen.motion, common);
  return 0;
}

}  // namespace

void add_fall_verb(VerbRegistry& registry) {
  auto options = std::make_shared<FallVerbOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "fall",
      "Let a person go limp and fall on the ground: film, picture of the end, or motion",
      "ecorche fall anna-anatomy.glb -o anna-falls.mp4 --push 0,0,1\n"
      "  ecorche fall anna-anatomy.glb -o anna-falls.bvh --from walk.bvh --at 0.1 --tone 0.3\n"
      "  ecorche fall anna-anatomy.glb -o anna-lies.png --from hug --height 1 --seconds 4",
      [options](const Common& common, Report& report) {
        return run_fall(*options, common, report);
      });
  add_character_option(*verb, options->character);
  verb->add_option("-o,--output", options->outputs,
                   "File to write; may be given several times: a film .mp4 or DIR/%04d.png, the "
                   "end as .png, the motion alone as .bvh, .glb or .fbx")
      ->required()
      ->allow_extra_args(false);
  verb->add_option("--from", options->from,
                   "A pose of data/poses/poses.csv; or a motion file, which goes on until --at")
      ->capture_default_str();
  verb->add_option("--at", options->at, "When the motion of --from is let go, s")
      ->check(between(0.0, 1e5));
  verb->add_option(
          "--height", options->height,
          "Metres over the ground, of the lowest point of a pose; a motion is raised by it")
      ->check(between(0.0, 20.0))
      ->capture_default_str();
  verb->add_option("--push", options->push,
                   "Shove at the middle of the chest: m/s that it gives it, X,Y,Z to the left, "
                   "upwards, forwards")
      ->expected(3)
      ->delimiter(',')
      ->check(between(-20.0, 20.0))
      ->default_str("0.2,0,0.4");
  verb->add_option("--tone", options->fall.tone,
                   "Muscles as springs towards the pose that was let go: 0 limp, 1 tense")
      ->check(between(0.0, 1.0))
      ->capture_default_str();
  verb->add_option("--seconds", options->fall.seconds, "How long, from when it is let go")
      ->check(between(0.1, 60.0))
      ->capture_default_str();
  verb->add_option("--fps", options->fall.fps, "Frames a second")
      ->check(between(10.0, 240.0))
      ->capture_default_str();
  verb->add_option("--size", options->size, "Of pictures, WIDTHxHEIGHT in pixels")
      ->capture_default_str();
  verb->add_option("--camera", options->camera, "From where, as render has it")
      ->capture_default_str();
}

}  // namespace ecorche
