// ecorche view: the window. Without a character it shows the template in its own body.
#include <optional>
#include <utility>
#include <vector>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "app/actor.h"
#include "app/body_sliders.h"
#include "app/eyes.h"
#include "app/fitting.h"
#include "app/motion_options.h"
#include "app/open_character.h"
#include "app/option_values.h"
#include "app/verb.h"
#include "morph/body.h"
#include "morph/template.h"
#include "skinning/flesh_motion.h"
#include "viewer/window.h"

namespace ecorche {
namespace {

struct ViewVerbOptions {
  std::filesystem::path character, motion, output;
  WindowOptions window;
  std::vector<double> pick;
  bool sliders = false, dynamics = false;
  std::string sex;
  std::vector<std::string> measures;
  MotionOptions retarget;
};

// The template's muscles fill the skin only once they are dilated, in its own body as in any other.
Actor open_actor(const std::filesystem::path& file, const std::string& sex, const Common& common, Report& report) {
  if (file.empty() && !sex.empty()) {
    BodySpec average;
    average.sex = sex == "female" ? Sex::female : Sex::male;
    const BodyPackage package = read_body_package(find_packages());
    return fit_character(read_template(), make_body(package, average), package, {}, report).actor;
  }
  if (!file.empty()) return make_actor(open_character(file, common, report), report);
  const Template shown = read_template();
  return fit_character(shown, shown.body, read_body_package(find_packages()), {}, report).actor;
}

int run(const ViewVerbOptions& options, const Common& common, Report& report) {
  const Actor actor = open_actor(options.character, options.sex, common, report);
  const Anatomy& anatomy = actor.character.anatomy;
  Motion motion;
  motion.frames.push_back(rest_pose(anatomy.skeleton));
  if (options.sliders && !options.motion.empty()) throw UsageError("view: --sliders show the body at rest; leave the motion away");
  if (!options.output.empty() && !options.sliders) throw UsageError("view: --output writes what --sliders made; without them there is nothing to write");
  if (!options.output.empty()) require_ending(options.output, {".glb"});
  check_outputs(common, {options.output, options.window.screenshot}, {options.character, options.motion});
  if (options.dynamics && options.motion.empty()) throw UsageError("view: --dynamics: flesh lags in a motion; name one");
  if (!options.motion.empty()) motion = open_motion(options.motion, actor.character, options.retarget, common, report);

  SceneOptions scene;
  scene.eyes = find_eyes(actor.character.body.skin, anatomy.skeleton);
  SceneModel model = make_scene_model(anatomy, actor.character.body.skin, scene);
  const FleshTables flesh = options.dynamics ? make_flesh_tables(actor.binding, anatomy) : FleshTables{};
  FleshState state;
  ActorFrame played;
  ViewSubject subject{anatomy, model, static_cast<int>(motion.frames.size()), motion.fps, [&](int frame, PosedAnatomy& posed, SkinFrame& skin) {
                              std::swap(played.posed, posed);
                              std::swap(played.skin, skin);
                              if (!flesh.vertices.empty()) seek_flesh(flesh, anatomy.skeleton, motion, {}, frame / motion.fps, state);
                              play(actor, motion.frames[frame], played, {}, state.seen);
                              std::swap(played.posed, posed);
                              std::swap(played.skin, skin);
                            }};
  ViewDocument document;
  std::optional<BodySliders> sliders;
  if (options.sliders) {
    sliders.emplace(actor, model);
    subject.sliders = sliders->sliders();
    subject.reshape = [&](const auto& asked, auto& achieved) {
      const StageTimer timer(report, "reshape");
      sliders->reshape(asked, achieved);
    };
    subject.pose = [&sliders](int, PosedAnatomy& posed, SkinFrame& skin) { sliders->pose(posed, skin); };
    document.asked = sliders->asked_by(options.measures);
  }
  document.playing = motion.frames.size() > 1;
  WindowOptions window = options.window;
  if (options.pick.size() == 2) window.pick_x = options.pick[0], window.pick_y = options.pick[1];
  run_window(subject, window, document);
  if (!options.output.empty()) sliders->write(options.output);
  return 0;
}

}  // namespace

void add_view_verb(VerbRegistry& registry) {
  auto options = std::make_shared<ViewVerbOptions>();
  CLI::App* verb = add_verb(registry, registry.app, "view", "Look at a character in a window: orbit, play, pick a bone or muscle",
                            "ecorche view anna-anatomy.glb walk.bvh",
                            [options](const Common& common, Report& report) { return run(*options, common, report); });
  verb->add_option("character", options->character, "Character written by `ecorche fit`, or CROWD.glb#NAME; the template when left out");
  verb->add_option("motion", options->motion, "Motion (.bvh)");
  verb->add_flag("--sliders", options->sliders, "Measures as sliders: the skin follows, bones, joints, muscles and binding are carried along");
  verb->add_option("-o,--output", options->output, "With --sliders: character to write when the window closes (.glb)");
  verb->add_option("--sex", options->sex, "Without a character: an average man or woman instead of the template")->check(one_of({"male", "female"}));
  verb->add_option("--measure", options->measures, "NAME=VALUE that a slider begins with; may be repeated");
  verb->add_option("--frames", options->window.frames, "Close after so many frames")->check(between(0, 1000000));
  verb->add_option("--pick", options->pick, "Pick what is seen at this place at the first frame: shares of the window's width and height")
      ->expected(2)
      ->delimiter(',')
      ->check(between(0.0, 1.0));
  verb->add_option("--screenshot", options->window.screenshot, "Save the last frame, panels included (.png)");
  add_dynamics_option(*verb, options->dynamics);
  add_motion_options(*verb, options->retarget);
}

}  // namespace ecorche
