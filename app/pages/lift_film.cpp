#include "app/pages/lift_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "anatomy/files/atomic_file.h"
#include "app/progress.h"
#include "viewer/lettering.h"

namespace ecorche {
namespace {

constexpr float kLowestSideLiftFilm = 240;  // pixels; smaller pictures have no room for words

double upward_sum(const LiftFrame& frame) {
  double sum = 0;
  for (const Vec3& force : frame.region) sum += force.y();
  return sum;
}

// Of the last second, so that what still swings does not count.
constexpr double kSettledSeconds = 1;

template <class Take>
double settled_mean(const LiftResult& result, const Take& take) {
  double sum = 0;
  int count = 0;
  for (const LiftFrame& frame : result.frames) {
    if (frame.time < result.frames.back().time - kSettledSeconds) continue;
    sum += take(frame);
    ++count;
  }
  return sum / count;
}

float peak_of(const LiftFrame& frame) {
  return frame.pressure.empty() ? 0 : *std::ranges::max_element(frame.pressure);
}

void write_words_lift(const CarryModel& model, const LiftFrame& frame, const LiftFilm& film,
                      Image& picture) {
  if (float(std::min(picture.width, picture.height)) < kLowestSideLiftFilm) return;
  const float size = 0.026f * float(picture.height), edge = 1.4f * size;
  const float right = float(picture.width) - edge;
  draw_pressure_legend(picture, right - kPressureLegendWidth * size,
                       float(picture.height) - edge - 4 * size, size, film.scale);
  const TextStyle style{.size = size, .align = Align::right};
  std::vector<std::string> lines{fmt::format("{:.1f} s    on the skin {:.0f} N    peak {:.1f} kPa",
                                             frame.time, upward_sum(frame), peak_of(frame) / 1e3)};
  if (model.sheet)
    lines.push_back(
        fmt::format("straps {:.0f} N    mattress {:.0f} N", frame.strap_lift, frame.mattress_lift));
  if (!frame.pads.empty()) {
    std::string pads;
    for (std::size_t k = 0; k < frame.pads.size(); ++k)
      pads += fmt::format("{}{} {:.0f} N", k ? "    " : "", model.pads[k].name,
                          frame.pads[k].dot(model.pads[k].X_WP.linear().col(1)));
    lines.push_back(pads);
  }
  lines.push_back("at the right: as seen from below");
  for (std::size_t i = 0; i < lines.size(); ++i)
    draw_text(picture, lines[i], right, edge + size * (1 + 1.35f * float(i)), style);
}

// Of the frames a film shows: all, or the last one of a still.
std::vector<LiftFrame> shown_frames(const LiftResult& lift, const LiftFilm& film) {
  const bool still =
      film.output.extension() == ".png" && film.output.string().find('%') == std::string::npos;
  if (still) return {lift.frames.back()};
  return lift.frames;
}

void report_figures(const std::string& name, const PressureFigures& figures, Report& report) {
  report.set(name + ".force", figures.force);
  report.set(name + ".peak_kpa", figures.peak / 1e3);
  report.set(name + ".mean_kpa", figures.mean / 1e3);
  report.set(name + ".area_cm2", 1e4 * figures.area);
  report.set(name + ".area_over_4_3_kpa_cm2", 1e4 * figures.area_capillary);
  report.set(name + ".area_over_9_3_kpa_cm2", 1e4 * figures.area_high);
}

// Those of the last frame.
CarryForces only_pad(CarryForces forces, int pad) {
  for (std::size_t i = 0; i < forces.pad.size(); ++i)
    if (forces.pad[i] != pad) forces.pressure[i] = forces.contact_area[i] = 0;
  return forces;
}

PressureMap last_map(const CarryModel& model, const LiftResult& result) {
  return measure_pressure(model.patient, result.last.forces.pressure,
                          result.last.forces.contact_area);
}

}  // namespace

FilmReport film_lift(const CarryModel& model, const LiftResult& lift, const LiftFilm& film,
                     const Common& common) {
  const std::vector<LiftFrame> frames = shown_frames(lift, film);
  CarriedLook look;
  look.scale = film.scale;
  look.from_below = beside_the_feet(frames);
  look.mattress = true;
  const Camera camera = carried_camera(model, frames, look, float(film.width) / float(film.height));
  FilmOptions options;
  options.output = film.output;
  options.width = film.width;
  options.height = film.height;
  options.video.fps = film.fps;
  options.finish = [&](int f, Image& picture) {
    write_words_lift(model, frames[std::size_t(f)], film, picture);
  };
  const FrameSource source = [&](int f, Scene& scene) {
    carried_scene(model, frames[std::size_t(f)], look, std::uint64_t(f) + 1, scene.list);
    scene.list.camera = camera;
  };
  Progress progress(common, film.output.filename().string(), int(frames.size()));
  return make_film(options, int(frames.size()), source, [&](int done) { progress.at(done); });
}

void write_force_table(const std::filesystem::path& file, const CarryModel& model,
                       const LiftResult& lift) {
  std::string out = "time";
  for (const std::string& region : model.patient.regions) out += "," + region;
  out += ",all,straps,mattress,peak_kpa\n";
  for (const LiftFrame& frame : lift.frames) {
    out += fmt::format("{:.4f}", frame.time);
    for (const Vec3& force : frame.region) out += fmt::format(",{:.2f}", force.y());
    out += fmt::format(",{:.2f},{:.2f},{:.2f},{:.3f}\n", upward_sum(frame), frame.strap_lift,
                       frame.mattress_lift, peak_of(frame) / 1e3);
  }
  write_file_atomically(file, out);
}

PressureFigures pad_figures(const CarryModel& model, const LiftResult& result, int pad) {
  const CarryForces forces = only_pad(result.last.forces, pad);
  return measure_pressure(model.patient, forces.pressure, forces.contact_area).whole;
}

void report_pressure(const std::string& name, const CarryModel& model, const LiftResult& result,
                     Report& report) {
  const PressureMap map = last_map(model, result);
  const double weight = model.patient.mass() * model.options.gravity;
  report.set(name + ".weight", weight);
  report.set(name + ".contact_force", settled_mean(result, upward_sum));
  if (model.sheet) {
    const double sheet = std::accumulate(model.sheet->mass.begin(), model.sheet->mass.end(), 0.0);
    report.set(name + ".sheet_weight", sheet * model.options.gravity);
    report.set(name + ".strap_force",
               settled_mean(result, [](const LiftFrame& f) { return f.strap_lift; }));
    report.set(name + ".nodes", int(model.sheet->mesh.V.rows()));
  }
  report.set(name + ".mattress_force",
             settled_mean(result, [](const LiftFrame& f) { return f.mattress_lift; }));
  report_figures(name, map.whole, report);
  for (std::size_t r = 0; r < map.regions.size(); ++r)
    if (map.regions[r].force > 0)
      report_figures(name + ".regions." + model.patient.regions[r], map.regions[r], report);
  for (std::size_t k = 0; k < model.pads.size(); ++k) {
    report_figures(name + "." + model.pads[k].name, pad_figures(model, result, int(k)), report);
    report.set(name + "." + model.pads[k].name + ".lift", result.last.forces.pads[k].y());
  }
  double excess = 0;
  for (const LiftFrame& frame : result.frames) excess = std::max(excess, frame.limit_excess);
  report.set(name + ".limit_excess_deg", excess * kDegreesPerRadian);
  report.set(name + ".seconds", result.last.time);
  report.set(name + ".core_seconds", result.core_seconds);
  report.set(name + ".times_real_time", result.last.time / std::max(result.seconds, 1e-9));
}

void print_regions(const CarryModel& model, const LiftResult& result) {
  const PressureMap map = last_map(model, result);
  std::vector<std::size_t> order(map.regions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return map.regions[a].force > map.regions[b].force;
  });
  fmt::print("{:<14} {:>9} {:>9} {:>9} {:>9} {:>11} {:>11}\n", "region", "force, N", "peak, kPa",
             "mean, kPa", "area, cm2", ">4.3 kPa", ">9.3 kPa");
  const auto row = [](const std::string& name, const PressureFigures& f) {
    fmt::print("{:<14} {:>9.1f} {:>9.2f} {:>9.2f} {:>9.0f} {:>11.0f} {:>11.0f}\n", name, f.force,
               f.peak / 1e3, f.mean / 1e3, 1e4 * f.area, 1e4 * f.area_capillary, 1e4 * f.area_high);
  };
  for (const std::size_t r : order)
    if (map.regions[r].force > 0.5) row(model.patient.regions[r], map.regions[r]);
  row("all", map.whole);
}

}  // namespace ecorche
