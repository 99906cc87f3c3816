// What lift, lie and sit ask alike: the person, the tissue, the picture.
#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>

#include "app/pages/lift_film.h"
#include "skinning/lift/patient.h"

namespace ecorche {

// Forces of the settled body beside its weight; more is told as a missed target.
inline constexpr double kForceError = 0.01;

struct CarriedOptions {
  std::filesystem::path character;
  std::string size = "1280x720";
  double scale_kpa = 12, tissue_kpa = 40;
  LiftFilm film;

  FleshOptions flesh() const { return {.modulus = 1e3 * tissue_kpa}; }
};

void add_step_option(CLI::App& verb, double& step);
void add_tissue_option(CLI::App& verb, CarriedOptions& options);
// --scale, --size.
void add_picture_options(CLI::App& verb, CarriedOptions& options);
// The pictures', and --fps.
void add_film_options(CLI::App& verb, CarriedOptions& options);
// Sets the film's size and scale. Throws UsageError for what is no size.
void set_picture(CarriedOptions& options);

}  // namespace ecorche
