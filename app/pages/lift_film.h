// A lift as a film, a still of its end, and a table of forces over time; a resting body as a
// picture.
#pragma once

#include <filesystem>
#include <string>

#include "app/common_options.h"
#include "app/pages/carried_scene.h"
#include "app/report.h"
#include "skinning/lift/pressure_map.h"
#include "viewer/film/film.h"

namespace ecorche {

struct LiftFilm {
  std::filesystem::path output;  // FILM.mp4, DIR/%04d.png, or STILL.png of the end
  int width = 1280, height = 720;
  double fps = 30;
  double scale = 12e3;  // Pa at the end of the colours
};

// Throws as make_film.
FilmReport film_lift(const CarryModel& model, const LiftResult& lift, const LiftFilm& film,
                     const Common& common);

// A line a frame: seconds, force of every region and of all, N upwards, of straps and mattress,
// peak pressure, kPa. Throws OutputError.
void write_force_table(const std::filesystem::path& file, const CarryModel& model,
                       const LiftResult& lift);

// Of what presses on one of the model's pads, at the end.
PressureFigures pad_figures(const CarryModel& model, const LiftResult& result, int pad);

// Under `name`: weight, forces, peak and areas, whole, by region and by pad.
void report_pressure(const std::string& name, const CarryModel& model, const LiftResult& result,
                     Report& report);

// Table of the regions on stdout, largest force first.
void print_regions(const CarryModel& model, const LiftResult& result);

}  // namespace ecorche
