// ecorche render: a character's motion as a film or as pictures.
#include <fmt/format.h>

#include <sstream>
#include <vector>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "app/activation_options.h"
#include "app/actor_film.h"
#include "app/motion_options.h"
#include "app/open_character.h"
#include "app/option_values.h"
#include "app/picture_size.h"
#include "app/verb.h"

namespace ecorche {
namespace {

struct RenderVerbOptions {
  std::filesystem::path character, motion, weights;
  std::string activation = "none", layers = "skin,muscles,bones", size = "1280x720", skin = "ecorche";
  std::vector<double> dissolve;
  bool colour_map = false;
  MotionOptions retarget;
  ActorFilm film;
};

void set_layers(const std::string& text, ActorFilm& film) {
  film.skin = film.muscles = film.bones = false;
  std::istringstream names(text);
  for (std::string name; std::getline(names, name, ',');) {
    if (name == "skin") film.skin = true;
    else if (name == "muscles") film.muscles = true;
    else if (name == "bones") film.bones = true;
    else throw UsageError(fmt::format("--layers: '{}' is no layer; there are skin, muscles and bones", name));
  }
}

void set_size(const std::string& text, ActorFilm& film) {
  if (!read_picture_size(text, film.width, film.height))
    throw UsageError(fmt::format("--size: '{}' is no size; write WIDTHxHEIGHT, for example 1280x720", text));
}

int run(RenderVerbOptions options, const Common& common, Report& report) {
  set_layers(options.layers, options.film);
  set_size(options.size, options.film);
  if (options.dissolve.size() == 2) options.film.dissolve = Span{options.dissolve[0], options.dissolve[1]};
  if (options.colour_map) options.film.muscle_colors = MuscleColors::shortening;
  const bool film = options.film.output.extension() == ".mp4";
  check_outputs(common, film ? std::vector{options.film.output} : std::vector<std::filesystem::path>(),
                {options.character, options.motion, options.weights, options.activation, options.retarget.map_file});
  require_settling(options.film.dynamics, options.skin);
  Actor actor = make_actor(open_character(options.character, common, report), report, {.weights = options.weights});
  choose_skin(actor, options.skin);
  const Motion motion = open_motion(options.motion, actor.character, options.retarget, common, report);
  options.film.ground.visible = true;
  options.film.activations = open_activations(options.activation, actor, motion, report);
  const FilmReport filmed = film_actor(actor, motion, options.film, common);
  report.set("timings_ms.film", 1e3 * filmed.seconds);
  report.set("film.frames", filmed.frames);
  report.set("film.driver", filmed.driver);
  note(common, fmt::format("{}: {} frames of {}x{} in {:.1f} s", options.film.output.string(), filmed.frames, filmed.width, filmed.height, filmed.seconds));
  return 0;
}

}  // namespace

void add_render_verb(VerbRegistry& registry) {
  auto options = std::make_shared<RenderVerbOptions>();
  CLI::App* verb = add_verb(registry, registry.app, "render", "Film a character's motion",
                            "ecorche render anna-anatomy.glb walk.bvh -o anna.mp4 --layers muscles,bones --camera left",
                            [options](const Common& common, Report& report) { return run(*options, common, report); });
  verb->add_option("character", options->character, "Character written by `ecorche fit`, or CROWD.glb#NAME")->required();
  verb->add_option("motion", options->motion, "Motion (.bvh)")->required();
  verb->add_option("-o,--output", options->film.output, "FILM.mp4, or numbered pictures DIR/%04d.png")->required();
  verb->add_option("--layers", options->layers, "What is seen: skin, muscles, bones; the skin is glass over other layers")->capture_default_str();
  add_skin_option(*verb, options->skin);
  add_weights_option(*verb, options->weights);
  verb->add_flag("--beside", options->film.beside, "The skin, and the figure without it beside it");
  verb->add_option("--dissolve", options->dissolve, "The skin goes, from the feet up, between these two moments of the motion, in seconds")
      ->expected(2)
      ->delimiter(',');
  verb->add_flag("--colour-map", options->colour_map, "Muscle lengths in orange and blue that colour-blind eyes tell apart");
  verb->add_flag("!--no-legend", options->film.legend, "Leave away what the muscles' colours mean");
  verb->add_option("--size", options->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  verb->add_option("--fps", options->film.fps, "Frames a second")->check(between(1.0, 240.0))->capture_default_str();
  verb->add_option("--camera", options->film.camera, "follow; or front, back, left, right, top, oblique, or AZIMUTH,ELEVATION in degrees")
      ->capture_default_str();
  verb->add_option("--activation", options->activation, kActivationHelp)->capture_default_str();
  add_dynamics_option(*verb, options->film.dynamics);
  add_motion_options(*verb, options->retarget);
}

}  // namespace ecorche
