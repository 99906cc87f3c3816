#include "app/verbs/lift/carried_options.h"

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "app/options/option_values.h"
#include "app/options/picture_size.h"

namespace ecorche {

void add_step_option(CLI::App& verb, double& step) {
  verb.add_option("--step", step, "Seconds of a step of the simulation; 1/60 when left out")
      ->check(between(0.0005, 0.025));
}

void add_tissue_option(CLI::App& verb, CarriedOptions& options) {
  verb.add_option("--tissue", options.tissue_kpa,
                  "Modulus of skin, fat and relaxed muscle over bone, kPa")
      ->check(between(2.0, 1000.0))
      ->capture_default_str();
}

void add_picture_options(CLI::App& verb, CarriedOptions& options) {
  verb.add_option("--scale", options.scale_kpa, "kPa at the end of the colours")
      ->check(between(1.0, 1000.0))
      ->capture_default_str();
  verb.add_option("--size", options.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
}

void add_film_options(CLI::App& verb, CarriedOptions& options) {
  add_picture_options(verb, options);
  verb.add_option("--fps", options.film.fps, "Frames a second")
      ->check(between(1.0, 60.0))
      ->capture_default_str();
}

void set_picture(CarriedOptions& options) {
  require_picture_size(options.size, options.film.width, options.film.height);
  options.film.scale = 1e3 * options.scale_kpa;
}

}  // namespace ecorche
