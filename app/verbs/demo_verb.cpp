#include "app/verbs/demo_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/files/fitted_actor.h"
#include "app/files/motion_figures.h"
#include "app/files/open_motion.h"
#include "app/options/activation_options.h"
#include "app/options/option_values.h"
#include "app/options/picture_size.h"
#include "app/pages/actor_film.h"
#include "app/pages/demo_page.h"
#include "app/pages/demo_pictures.h"
#include "morph/shapes/standard_bodies.h"
#include "morph/template/template_cache.h"
#include "skinning/checks/motion_survey.h"
#include "skinning/files/character_write.h"
#include "skinning/files/clip_shapes.h"
#include "skinning/files/pc2_io.h"
#include "skinning/motion/activation.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct DemoOptions {
  std::string activation = "none", size = "1280x720";
  fs::path folder = "out/long-jump";
  double fps = ActorFilm{}.fps;
};

// The motion's world: the take-off line lies at z = 0 and the pit begins a metre behind it
// (data/motions/make_long_jump.py). `scale`: metres of our figure in one of the file's centimetres.
Ground jump_ground(double scale) {
  const double metre = 100 * scale;
  Ground ground;
  ground.visible = true;
  ground.color = Vec3f(0.66f, 0.70f, 0.60f);
  ground.grid = 0;
  ground.lanes = 2;
  ground.track_half_width = 1.5f;
  ground.pit_half_width = 1.9f;
  ground.track_begin = -60;
  ground.track_end = float(metre);
  ground.board = 1e-3f;
  ground.pit_begin = float(metre);
  ground.pit_end = float(10 * metre);
  return ground;
}

// The highest moment of the root, and when it was last and next at its mean running height:
// take-off and landing, for the curves.
std::vector<std::pair<double, std::string>> flight_events(const Motion& motion) {
  size_t top = 0;
  for (size_t f = 1; f < motion.frames.size(); ++f)
    if (motion.frames[f].root.y() > motion.frames[top].root.y()) top = f;
  const double ground = motion.frames.front().root.y();
  const double level = ground + 0.35 * (motion.frames[top].root.y() - ground);
  size_t up = top, down = top;
  while (up > 0 && motion.frames[up].root.y() > level) --up;
  while (down + 1 < motion.frames.size() && motion.frames[down].root.y() > level) ++down;
  return {{double(up) / motion.fps, "take-off"},
          {double(top) / motion.fps, "highest"},
          {double(down) / motion.fps, "landing"}};
}

// Selected muscles of the take-off leg: lengths and thicknesses relative to rest.
class MuscleCurves {
 public:
  MuscleCurves(const Actor& actor, std::vector<MuscleCurve>& curves) : curves_(curves) {
    const std::pair<const char*, const char*> wanted[] = {
        {"rectus_femoris_l", "rectus femoris"},
        {"vastus_lateralis_l", "vastus lateralis"},
        {"biceps_femoris_long_l", "biceps femoris, long head"},
        {"gluteus_maximus_middle_l", "gluteus maximus"},
        {"gastrocnemius_medial_l", "gastrocnemius, medial head"},
        {"soleus_l", "soleus"}};
    const Anatomy& anatomy = actor.character.anatomy;
    const auto ranges = slice_ranges(anatomy);
    PosedAnatomy rest;
    ContactWorkspace contact;
    pose_muscles(actor.muscles, anatomy.skeleton, rest_pose(anatomy.skeleton), rest, contact);
    for (const auto& [name, label] : wanted) {
      const int m = find_muscle(anatomy, name);
      const auto range = std::find_if(ranges.begin(), ranges.end(),
                                      [m](const SliceRange& r) { return r.muscle == m; });
      if (m < 0 || range == ranges.end()) continue;
      Followed one;
      one.strip = int(range - ranges.begin());
      one.slice = range->begin;
      for (int k = range->begin; k < range->end; ++k)
        if (rest.slices[k].radii.prod() > rest.slices[one.slice].radii.prod()) one.slice = k;
      one.length = rest.lengths[one.strip];
      one.thickness = rest.slices[one.slice].radii.y();
      followed_.push_back(one);
      curves_.push_back({label, {}, {}});
    }
  }

  void add(const PosedAnatomy& posed) {
    for (size_t i = 0; i < followed_.size(); ++i) {
      curves_[i].length.push_back(posed.lengths[followed_[i].strip] / followed_[i].length);
      curves_[i].thickness.push_back(posed.slices[followed_[i].slice].radii.y() /
                                     followed_[i].thickness);
    }
  }

 private:
  struct Followed {
    int strip = 0, slice = 0;
    double length = 1, thickness = 1;
  };
  std::vector<MuscleCurve>& curves_;
  std::vector<Followed> followed_;
};

// The same stages in a body of another build, as in the paper's figure 5.
Picture second_body(const Assets& assets, const Template& body_template,
                    const BodyPackage& package) {
  BodySpec woman;
  woman.sex = Sex::female;
  const Body body = make_body(package, woman);
  Report aside;
  const FittedActor fitted = fit_actor(assets, body_template, body, package, {}, aside);
  return picture_of_fit(body_template, body, fitted, package,
                        "The same template in a woman of average build (figure 5)");
}

void add_pictures(const Template& body_template, const BodyPackage& package,
                  const FittedActor& fitted, const Motion& jump, const Common& common,
                  DemoRecord& record) {
  const Character& character = fitted.actor.character;
  record.fit_pictures.push_back(
      picture_of_fit(body_template, character.body, fitted, package,
                     "From the template to the athlete (the paper's figure 4): his skin; the "
                     "template in it before it is "
                     "transformed; its bones transformed; its muscles transformed and shrunk; its "
                     "muscles dilated up to the "
                     "layer of fat and skin"));
  record.fit_pictures.push_back(second_body(common.assets, body_template, package));
  record.fit_pictures.push_back(picture_of_muscles(fitted, package));
  record.motion_pictures.push_back(picture_of_jump(fitted.actor, package, jump, record));
  Report aside;
  const Motion walk =
      open_motion(common.assets.tables / "motions" / "walk.bvh", fitted.actor, {}, common, aside);
  record.motion_pictures.push_back(picture_of_walk(fitted.actor, package, walk));
}

// Mean time of a frame, over every eighth one, evaluated one after the other.
double mean_frame_ms(const Actor& actor, const Motion& motion) {
  ActorState frame(actor);
  evaluate(actor, motion.frames[0], {}, frame);
  const auto start = std::chrono::steady_clock::now();
  int played = 0;
  for (size_t f = 0; f < motion.frames.size(); f += 8, ++played)
    evaluate(actor, motion.frames[f], {}, frame);
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
             .count() /
         played;
}

// Writes the vertex cache and collects the muscles' curves, the shapes for the .glb and the figures
// in one pass over the motion.
MotionQuality play_jump(const fs::path& cache, const Actor& actor, const Motion& motion,
                        const Activations& activations, const BodyPackage& package,
                        DemoRecord& record, ClipRecorder& clip, Report& report) {
  const StageTimer timer(report, "frames");
  Pc2Writer writer(cache, actor.binding.vertex_count);
  MuscleCurves curves(actor, record.curves);
  MotionRun pass{activations};
  pass.package = &package;
  pass.take = [&](int f, const CharacterState& frame) {
    writer.add_frame(frame.skin.positions);
    curves.add(frame.posed);
    clip.add(frame.posed, frame.skin);
    record.seconds.push_back(f / motion.fps);
  };
  const MotionQuality quality = play_motion(actor, motion, pass);
  writer.finish();
  return quality;
}

Template timed_template(const Assets& assets, Report& report) {
  const StageTimer timer(report, "template");
  return read_template(assets);
}

int run_demo(const DemoOptions& options, const Common& common, Report& report) {
  ActorFilm film;
  require_picture_size(options.size, film.width, film.height);
  film.fps = options.fps;
  make_output_folder(options.folder);
  note(common, "template");
  const Template body_template = timed_template(common.assets, report);
  const BodyPackage package = read_body_package(common.assets);

  note(common, "fit");
  const Body body = make_body(package, athlete());
  const FittedActor fitted = fit_actor(common.assets, body_template, body, package, {}, report);
  const Actor& actor = fitted.actor;
  const Anatomy& anatomy = actor.character.anatomy;
  report.set("bones", int(anatomy.bones.size()));
  report.set("muscles", int(anatomy.muscles.size()));
  report.set("strips", actor.muscles.posing.strips());
  report.set("slices", actor.muscles.posing.slices());
  report.set("skin_vertices", actor.binding.vertex_count);

  note(common, "motion");
  const Motion motion =
      open_motion(common.assets.tables / "motions" / "long_jump.bvh", actor, {}, common, report);
  report.set("frame_ms", mean_frame_ms(actor, motion));
  const Activations activations = open_activations(
      options.activation, read_activation_table(common.assets, options.activation, anatomy), actor,
      motion, report);

  note(common, "files");
  DemoRecord record;
  ClipRecorder clip(actor.character, actor.binding);
  const MotionQuality quality = play_jump(options.folder / "long-jump.pc2", actor, motion,
                                          activations, package, record, clip, report);
  const ClipShapes shapes = clip.finish();
  write_character(options.folder / "athlete.glb", actor.character, actor.binding, &motion,
                  find_look(package, actor.character.body.skin, anatomy.skeleton), &shapes);
  report_quality(quality, "quality", report);

  film.output = options.folder / "long-jump.mp4";
  film.beside = true;
  film.activations = activations;
  record.events = flight_events(motion);
  const double takeoff = record.events[0].first, landing = record.events[2].first;
  film.dissolve = Span{0.15 * takeoff, 0.6 * takeoff};
  film.slow = Span{takeoff - 0.15, landing + 0.1};
  film.ground = jump_ground(report.number("motion.scale"));
  const FilmReport filmed = film_actor(actor, motion, film, common);
  report.set("timings_ms.film", 1e3 * filmed.seconds);
  report.set("film.frames", filmed.frames);
  report.set("film.driver", filmed.driver);

  note(common, "pictures");
  add_pictures(body_template, package, fitted, motion, common, record);
  for (const MissedTarget& target : missed_targets(fitted.report))
    record.missed.push_back(target.what);
  const auto in_motion = missed_targets(quality);
  record.missed.insert(record.missed.end(), in_motion.begin(), in_motion.end());
  const auto& missed = record.missed;
  for (const std::string& target : missed) report.append_text("missed", target);
  write_file_atomically(options.folder / "report.html", demo_page(record, report));
  report.set("exit_code", missed.empty() ? 0 : 8);
  report.write(options.folder / "report.json");
  for (const std::string& target : missed) note(common, "missed: " + target);
  note(
      common,
      fmt::format("look at {0}/long-jump.mp4 and {0}/report.html; {0}/athlete.glb opens in Blender",
                  options.folder.string()));
  return missed.empty() ? 0 : 8;
}

}  // namespace

void add_demo_verb(VerbRegistry& registry) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App* verb =
      add_verb(registry, registry.app, "demo",
               "An athlete's long jump, end to end: film, character, vertex cache, report",
               "ecorche demo -o out/long-jump", [options](const Common& common, Report& report) {
                 return run_demo(*options, common, report);
               });
  verb->add_option("-o,--output", options->folder, "Folder to write to; made where it is missing")
      ->capture_default_str();
  verb->add_option("--size", options->size,
                   "Of the film, WIDTHxHEIGHT in pixels; smaller ones are made sooner")
      ->capture_default_str();
  verb->add_option("--fps", options->fps, "Frames a second of the film; fewer are made sooner")
      ->check(between(1.0, 240.0))
      ->capture_default_str();
  add_activation_option(*verb, options->activation);
}

}  // namespace ecorche
