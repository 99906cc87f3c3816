#include "app/verbs/view_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/options/motion_options.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "app/studio/view_session.h"
#include "viewer/camera.h"
#include "viewer/part_names.h"
#include "viewer/window/window.h"

namespace ecorche {
namespace {

struct ViewVerbOptions {
  ViewSessionOptions session;
  std::filesystem::path output;
  WindowOptions window;
  std::vector<double> pick;
  std::string camera, hide, only;
};

void check_options_view(const ViewVerbOptions& options, const Common& common) {
  const ViewSessionOptions& session = options.session;
  if (session.sliders && !session.motion.empty())
    throw UsageError("view: --sliders show the body at rest; leave the motion away");
  if (!options.output.empty() && !session.sliders)
    throw UsageError(
        "view: --output writes what --sliders made; without them there is nothing to write");
  if (!options.output.empty()) require_ending(options.output, {".glb"});
  check_outputs(common, {options.output, options.window.screenshot},
                {session.character, session.motion, session.retarget.map_file});
  if (session.dynamics && session.motion.empty())
    throw UsageError("view: --dynamics: flesh lags in a motion; name one");
  if (!session.measures.empty() && !session.sliders)
    throw UsageError("view: --measure is where a slider begins; say --sliders");
}

// Initial state of the window.
ViewDocument first_view(const ViewVerbOptions& options, const ViewSession& session) {
  ViewDocument document = session.document();
  const Anatomy& anatomy = *session.subject().anatomy;
  document.hidden = parts_of_list(anatomy, options.hide, "--hide");
  if (!options.only.empty()) {
    const std::vector<std::uint32_t> only = parts_of_list(anatomy, options.only, "--only");
    for (const std::uint32_t part : all_parts(anatomy))
      set_hidden(part, !std::ranges::binary_search(only, part), document);
  }
  if (options.camera.empty()) return document;
  const ViewAngles angles = view_angles(options.camera);
  document.azimuth = angles.azimuth;
  document.elevation = angles.elevation;
  return document;
}

int run_view(ViewVerbOptions options, const Common& common, Report& report) {
  check_options_view(options, common);
  if (options.pick.size() == 2)
    options.window.pick_x = options.pick[0], options.window.pick_y = options.pick[1];
  ViewSession session(options.session, common, report);
  const ViewDocument last =
      run_window(session.subject(), options.window, first_view(options, session));
  return options.output.empty()
             ? session.exit_code()
             : std::max(session.exit_code(), session.write(last, options.output));
}

}  // namespace

void add_view_verb(VerbRegistry& registry) {
  auto options = std::make_shared<ViewVerbOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "view",
      "Look at a character in a window: orbit, play, pick, hide or isolate bones and muscles; F1 "
      "shows the keys",
      "ecorche view anna-anatomy.glb walk.bvh\n  ecorche view anna-anatomy.glb --sliders -o "
      "anna-heavier.glb",
      [options](const Common& common, Report& report) {
        return run_view(*options, common, report);
      });
  ViewSessionOptions& session = options->session;
  verb->add_option(
      "character", session.character,
      "Character written by `ecorche fit`, or CROWD.glb#NAME; the template when left out");
  verb->add_option(
      "motion", session.motion,
      std::string(kMotionFilesHelp) + "; others can be opened or dropped into the window");
  verb->add_flag(
      "--sliders", session.sliders,
      "Measures as sliders: the skin follows with bones and muscles, which are then fitted anew");
  verb->add_option("-o,--output", options->output,
                   "With --sliders: character to write when the window closes (.glb); ends with 8 "
                   "where it misses what `fit` asks");
  verb->add_option("--template", session.body_template,
                   "Template of `ecorche template import` that --sliders fit with; the built-in "
                   "one when left out");
  add_sex_option(*verb, session.sex,
                 "Without a character: an average man or woman instead of the template");
  verb->add_option("--measure", session.measures,
                   "NAME=VALUE that a slider begins with; may be repeated");
  verb->add_option("--camera", options->camera,
                   fmt::format("Where the eye is first: {}", view_names()));
  CLI::Option* hide = verb->add_option(
      "--hide", options->hide, "Parts that are hidden first, named as for `ecorche render`");
  verb->add_option("--only", options->only, "The only parts that are shown first")->excludes(hide);
  verb->add_option("--frames", options->window.frames,
                   "Close after so many frames; the last one waits for what is being fitted")
      ->check(between(0, 1000000));
  verb->add_option("--pick", options->pick,
                   "Pick what is seen at this place at the first frame: shares of the window's "
                   "width and height")
      ->expected(2)
      ->delimiter(',')
      ->check(between(0.0, 1.0));
  verb->add_option("--screenshot", options->window.screenshot,
                   "Save the last frame, panels included (.png)");
  add_dynamics_option(*verb, session.dynamics);
  add_definition_option(*verb, session.definition);
  add_motion_options(*verb, session.retarget);
  add_range_options(*verb, session.retarget);
}

}  // namespace ecorche
