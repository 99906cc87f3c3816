#include "app/verbs/studio/studio_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include "anatomy/errors.h"
#include "app/edit/project.h"
#include "app/edit/session.h"
#include "app/edit/unsaved_sessions.h"
#include "app/options/picture_size.h"
#include "app/pages/actor_film.h"
#include "app/pages/film_shots.h"
#include "viewer/part_names.h"
#ifdef ECORCHE_WINDOW
#include "app/studio/design/design_window.h"
#endif

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct StudioOptions {
  fs::path start, motion, output, project;
  std::string recover, forget;
  std::vector<fs::path> scripts;
  // of the window
  fs::path input, screenshot;
  std::string size = "1280x800";
  int frames = 0;
  bool list = false, json = false, discard = false;
};

void set_layers_of(const std::string& text, ActorFilm& film) {
  film.skin = text.find("skin") != std::string::npos;
  film.muscles = text.find("muscles") != std::string::npos;
  film.bones = text.find("bones") != std::string::npos;
  if (!film.skin && !film.muscles && !film.bones)
    throw InputError(
        fmt::format("argument 'layers': '{}': expected some of skin, muscles, bones", text));
}

void set_ground(const std::string& text, ActorFilm& film) {
  film.ground.visible = text == "outdoors";
  film.transparent = text == "transparent";
  if (film.ground.visible || film.transparent) return;
  unsigned red = 255, green = 255, blue = 255;
  char more = 0;
  if (text != "white" && (text.size() != 7 || std::sscanf(text.c_str(), "#%2x%2x%2x%c", &red,
                                                          &green, &blue, &more) != 3))
    throw InputError(fmt::format(
        "argument 'background': '{}': expected white, outdoors, transparent or #RRGGBB", text));
  film.background = Vec3f(float(red), float(green), float(blue)) / 255;
}

// Parts that are left away: those of `hide`, or all but those of `only`.
std::vector<std::uint32_t> hidden_parts(const Anatomy& anatomy, const Render& picture) {
  std::vector<std::uint32_t> out = parts_of_list(anatomy, picture.hide, "argument 'hide'");
  if (picture.only.empty()) return out;
  const std::vector<std::uint32_t> only = parts_of_list(anatomy, picture.only, "argument 'only'");
  for (const std::uint32_t part : all_parts(anatomy))
    if (!std::ranges::binary_search(only, part)) out.push_back(part);
  std::ranges::sort(out);
  return out;
}

void set_labels(const Tried& tried, const Render& picture, ActorFilm& film) {
  if (picture.labels.empty()) return;
  if (picture.labels == "picked" && tried.picked.empty())
    throw InputError("argument 'labels': 'picked': no muscle is; pick MUSCLE first");
  film.labels = parts_of_list(tried.own.actor->character.anatomy,
                              picture.labels == "picked" ? tried.picked : picture.labels,
                              "argument 'labels'");
}

void set_second(const Tried& tried, const Render& picture, ActorFilm& film) {
  if (!tried.other) return;
  SecondFigure& second = film.second.emplace();
  second.actor = tried.other->actor;
  second.motion = &tried.other->motion;
  second.activations = tried.other->activations;
  second.hidden = hidden_parts(tried.other->actor->character.anatomy, picture);
  second.pairing = tried.comparison.wiped ? Pairing::wiped : Pairing::beside;
  second.wipe = float(tried.comparison.share);
  second.first_name = tried.names.own;
  second.name = tried.names.other;
}

// What the actions `render` and `film` ask for.
void draw(const Tried& tried, const Film& asked, const Common& common) {
  const Render& picture = asked.picture;
  const Actor& actor = *tried.own.actor;
  const Anatomy& anatomy = actor.character.anatomy;
  ActorFilm film;
  film.activations = tried.own.activations;
  film.output = picture.file;
  film.fps = asked.fps;
  film.from = film.to = 0;
  film.muscle_colors = picture.colour == "length"       ? MuscleColors::shortening
                       : picture.colour == "activation" ? MuscleColors::activation
                                                        : MuscleColors::flesh;
  film.legend = film.muscle_colors != MuscleColors::flesh;
  set_layers_of(picture.layers, film);
  set_ground(picture.background, film);
  if (!read_picture_size(picture.size, film.width, film.height))
    throw InputError(fmt::format("argument 'size': '{}': expected WIDTHxHEIGHT", picture.size));
  film.hidden = hidden_parts(anatomy, picture);
  set_labels(tried, picture, film);
  set_second(tried, picture, film);
  if (!picture.section.empty())
    film.section = read_section_plane(picture.section, anatomy.skeleton, "argument 'section'");
  if (!asked.shots.empty())
    film.shots = read_shots(asked.shots, tried.moment, tried.own.motion.frames.size() > 1,
                            "argument 'shots'");
  film.view.look_at = picture.look_at;
  film.view.camera = !picture.camera.empty()   ? picture.camera
                     : picture.look_at.empty() ? "oblique"
                                               : "follow";
  film_actor(actor, tried.own.motion, film, common);
}

bool wants_window(const StudioOptions& options) {
  return options.scripts.empty() && options.output.empty();
}

void check_studio_options(const StudioOptions& options, bool starts_with_project) {
  const bool window = wants_window(options);
  if (!window && (!options.input.empty() || !options.screenshot.empty() || options.frames > 0))
    throw UsageError(
        "studio: --input, --screenshot and --frames belong to the window; leave --script and "
        "--output away");
  if (!options.output.empty()) require_ending(options.output, {".glb"});
  if (!options.screenshot.empty()) require_ending(options.screenshot, {".png"});
  if (starts_with_project && !options.project.empty())
    throw UsageError("studio: START is a project already; leave --project away");
  if (!options.recover.empty() && !(options.start.empty() && options.project.empty()))
    throw UsageError(
        "studio: --recover goes on with a session that had no project; leave START and --project "
        "away");
  if (options.discard && options.project.empty() && !starts_with_project)
    throw UsageError("studio: --discard belongs to a project; name one");
}

void open_window(const StudioOptions& options, Session& session, const Common& common,
                 Report& report, const Session::Drawer& draw) {
#ifdef ECORCHE_WINDOW
  WindowOptions window{
      .frames = options.frames, .screenshot = options.screenshot, .input = options.input};
  if (!read_picture_size(options.size, window.width, window.height))
    throw UsageError(fmt::format("studio: --size '{}': expected WIDTHxHEIGHT", options.size));
  if (!session.has_project() && options.recover.empty()) session.begin_here();
  run_design_window(session, common, report, draw, window);
#else
  (void)options, (void)session, (void)common, (void)report, (void)draw;
  throw UsageError(
      "studio: this program was built without a window; say --script FILE, or --list-actions for "
      "what it may hold");
#endif
}

void forget_sessions(const std::string& name, const Common& common) {
  const fs::path folder = unsaved_sessions_folder();
  const std::vector<UnsavedSession> all =
      name == "all" ? unsaved_sessions(folder) : std::vector{find_unsaved_session(folder, name)};
  for (const UnsavedSession& session : all) {
    forget_unsaved_session(session.folder);
    note(common, fmt::format("forgotten: {} ({})", session.name, unsaved_session_text(session)));
  }
}

// Goes on with one that was left, or tells of those there are. A window asks by itself.
void take_up_or_tell(const StudioOptions& options, Session& session, const Common& common,
                     Report& report) {
  const fs::path folder = unsaved_sessions_folder();
  if (!options.recover.empty()) {
    const std::string fault = session.take_up(find_unsaved_session(folder, options.recover).folder);
    if (!fault.empty()) note(common, "done again up to a line that this version refuses: " + fault);
    return;
  }
  const std::vector<UnsavedSession> left = unsaved_sessions(folder);
  report.set("unsaved_sessions", int(left.size()));
  for (const UnsavedSession& each : left)
    note(common, fmt::format("a session that was not saved is left ({}): --recover {} goes on "
                             "with it, --forget {} removes it",
                             unsaved_session_text(each), each.name, each.name));
}

// What a script did can be done again by it; a window that fails leaves its journal.
void run_scripts(const StudioOptions& options, Session& session) {
  try {
    for (const fs::path& script : options.scripts) session.run_script(script);
  } catch (...) {
    if (options.recover.empty()) session.forget_unsaved();
    throw;
  }
}

int run_studio(const StudioOptions& options, const Common& common, Report& report) {
  if (options.json && !options.list) throw UsageError("studio: --json belongs to --list-actions");
  if (options.list) {
    fmt::print("{}", options.json ? list_of_actions_json() : list_of_actions());
    return 0;
  }
  if (!options.forget.empty()) {
    forget_sessions(options.forget, common);
    return 0;
  }
  // a project that was never saved is its journal alone
  const bool starts_with_project =
      !options.start.empty() &&
      (is_project(options.start) || fs::is_regular_file(options.start / kJournalFile));
  check_studio_options(options, starts_with_project);
  std::vector<fs::path> inputs = options.scripts;
  inputs.push_back(options.input);
  check_outputs(common, {options.output, options.screenshot}, inputs);
  const Session::Drawer drawer = [&common](const Tried& tried, const Film& film) {
    draw(tried, film, common);
  };
  Session session(common, report,
                  {starts_with_project ? options.start : options.project, options.discard}, drawer);
  if (!options.start.empty() && !starts_with_project) session.run(SetBody{options.start.string()});
  if (!options.motion.empty()) session.run(PlayMotion{options.motion.string()});
  session.keep_unsaved(unsaved_sessions_folder());
  take_up_or_tell(options, session, common, report);
  const std::size_t before = session.history().now;
  run_scripts(options, session);
  if (wants_window(options)) open_window(options, session, common, report, drawer);
  // what was done again at the start may be undone
  const int actions = std::max(int(session.history().now) - int(before), 0);
  report.set("actions", actions);
  note(common, fmt::format("{} actions", actions));
  std::vector<std::string> missed;
  if (!options.output.empty()) missed = session.write(options.output);
  session.forget_unsaved();
  for (const std::string& text : missed) note(common, "missed: " + text);
  return missed.empty() ? 0 : 8;
}

}  // namespace

void add_studio_verb(VerbRegistry& registry) {
  auto options = std::make_shared<StudioOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "studio",
      "Change muscles, joints and body by hand in a window, or by actions of a script; undone "
      "and saved as text",
      "ecorche studio anna.glb walk.bvh\n  ecorche studio --list-actions\n  ecorche "
      "studio anna.glb --script arm.txt -o "
      "anna-arm.glb\n  ecorche studio --project my-arm --script more.txt",
      [options](const Common& common, Report& report) {
        return run_studio(*options, common, report);
      });
  verb->add_option("start", options->start,
                   "Body, character or skin on the base mesh that muscles are fitted into, or a "
                   "project's folder; the template's own body when left out");
  verb->add_option("motion", options->motion, "Motion that it is tried in (.bvh, .fbx, ...)");
  verb->add_option(
      "--script", options->scripts,
      "Actions, one a line, with # for remarks and `include FILE`, run without a window; "
      "may be repeated");
  verb->add_option("--project", options->project,
                   "Folder of the project: read where there is one, written by the action `save`; "
                   "what was not saved before is done again");
  verb->add_flag("--discard", options->discard,
                 "Leave away what was not saved of the project, say after a crash");
  verb->add_option("--recover", options->recover,
                   "Go on with a session that was killed before it was saved as a project: its "
                   "name, or `last`; a start tells which there are");
  verb->add_option("--forget", options->forget,
                   "Remove what such a session left, by its name, `last` or `all`, and end");
  verb->add_option(
      "-o,--output", options->output,
      "Character to write (.glb), fitted and bound as `ecorche fit` does it; ends with "
      "8 where it misses what `fit` asks");
  verb->add_option("--input", options->input,
                   "Play what a person does at the window from a text (docs/studio.md), and close");
  verb->add_option("--screenshot", options->screenshot,
                   "Save the last of --frames, panels included (.png)");
  verb->add_option("--frames", options->frames,
                   "Close after so many frames; the last one waits for what is being fitted")
      ->check(CLI::Range(0, 1000000));
  verb->add_option("--size", options->size, "Of the window, WIDTHxHEIGHT")->capture_default_str();
  verb->add_flag("--list-actions", options->list,
                 "Name all actions with their arguments, units and help");
  verb->add_flag("--json", options->json, "The list as JSON");
}

}  // namespace ecorche
