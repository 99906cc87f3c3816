#include "app/verbs/forces/dynamics_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/posing/posing_table.h"
#include "app/files/actor.h"
#include "app/files/body_inertia.h"
#include "app/files/dynamics_tables.h"
#include "app/files/open_character.h"
#include "app/files/open_motion.h"
#include "app/files/open_plates.h"
#include "app/options/activation_options.h"
#include "app/options/motion_options.h"
#include "app/options/option_values.h"
#include "app/pages/html_page.h"
#include "app/verbs/forces/effort_curves.h"
#include "skinning/dynamics/compare_ground.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

// Share of the weight that is missed where joints' moments say little; gaps between such frames
// that do not count, s; spans that are named.
constexpr double kDoubtful = 0.1, kSpanGap = 0.06;
constexpr std::size_t kMostSpans = 4;

struct DynamicsVerbOptions {
  fs::path character, motion, html, plates, activations;
  std::vector<fs::path> outputs;
  double cutoff = -1;
  std::optional<double> plates_start;
  std::string muscles;
  bool no_ground = false;
  MotionOptions retarget;
};

struct Found {
  const Skeleton& skeleton;
  const SegmentInertia& inertia;
  const MotionDynamics& dynamics;
  const std::optional<GroundComparison>& plates;  // none: without plates
  const Anatomy& anatomy;
  const std::optional<MuscleEfforts>& efforts;  // none: not asked for
  const std::vector<ChosenMuscles>& muscles;    // with curves
};

std::vector<double> seconds_of(const MotionDynamics& dynamics) {
  std::vector<double> out;
  for (std::size_t f = 0; f < dynamics.frames.size(); ++f) out.push_back(double(f) / dynamics.fps);
  return out;
}

template <class Value>
std::vector<double> each_frame(const MotionDynamics& dynamics, const Value& value) {
  std::vector<double> out;
  for (const DynamicsFrame& frame : dynamics.frames) out.push_back(value(frame));
  return out;
}

// Forwards is where the pelvis looks.
double forwards_of(const DynamicsFrame& frame, const Vec3& force) {
  Vec3 way = frame.loads.X_WJ[0].linear().col(2);
  way.y() = 0;
  return force.dot(way.normalized());
}

void add_ground_plots(const Found& found, HtmlPage& page) {
  const MotionDynamics& dynamics = found.dynamics;
  const auto add = [&](std::string title, const auto& component) {
    Plot plot{std::move(title), "s", "body weights", seconds_of(dynamics), {}, {}};
    for (const auto& [foot, word] :
         {std::pair<std::size_t, const char*>{0, "left"}, {1, "right"}}) {
      plot.series.push_back({word, each_frame(dynamics, [&, foot = foot](const DynamicsFrame& f) {
                               return component(f, f.estimated[foot].force) / dynamics.weight;
                             })});
      if (found.plates)
        plot.series.push_back(
            {fmt::format("{}, plate", word), each_frame(dynamics, [&, foot = foot](const auto& f) {
               return component(f, f.feet[foot].force) / dynamics.weight;
             })});
    }
    page.add_plot(plot);
  };
  add("Vertical ground reaction",
      [](const DynamicsFrame&, const Vec3& force) { return force.y(); });
  add("Ground reaction forwards (braking is negative)", forwards_of);
  Plot plot{"", "s", "body weights", seconds_of(dynamics), {}, {}};
  plot.title = "Residual: what neither motion nor ground explains";
  plot.series = {
      {"force", each_frame(dynamics,
                           [&](const DynamicsFrame& frame) {
                             return frame.residual_force.norm() / dynamics.weight;
                           })},
      {"moment / height of the centre", each_frame(dynamics, [&](const DynamicsFrame& frame) {
         return frame.residual_moment.norm() / (dynamics.weight * dynamics.center_height);
       })}};
  page.add_plot(plot);
}

void add_joint_plots(const Found& found, HtmlPage& page) {
  const MotionDynamics& dynamics = found.dynamics;
  const std::vector<MomentCurve> curves =
      moment_curves(found.skeleton, found.inertia.segments, dynamics);
  for (const std::string joint : {"hip", "knee", "ankle"}) {
    Plot moment{joint + ": moment of flexion (extension is negative)",
                "s",
                "N m/kg",
                seconds_of(dynamics),
                {},
                {}},
        power{joint + ": power (negative is taken up)", "s", "W/kg", seconds_of(dynamics), {}, {}};
    if (joint == "ankle") moment.title = "ankle: moment of flexion (plantar flexion is negative)";
    for (const auto& [side, word] : {std::pair{"_l", "left"}, std::pair{"_r", "right"}}) {
      const std::string name = joint + side + "_flexion";
      for (const MomentCurve& curve : curves)
        if (curve.name == name) {
          std::vector<double> y = curve.moment;
          for (double& value : y) value /= found.inertia.mass;
          moment.series.push_back({word, std::move(y)});
        }
      const int j = find_joint(found.skeleton, joint + side);
      power.series.push_back({word, each_frame(dynamics, [&](const DynamicsFrame& frame) {
                                return frame.loads.power[j] / found.inertia.mass;
                              })});
    }
    page.add_plot(moment);
    page.add_plot(power);
  }
}

// What is left out, as the end of a sentence; empty: nothing.
std::string beside_plates(const GroundComparison& c) {
  if (c.beside == 0) return "";
  return fmt::format(
      "; {} steps beside the plates are left out ({:.0f} % of the time is compared for both feet, "
      "{:.0f} and {:.0f} % for left and right)",
      c.beside, 100 * c.compared[2], 100 * c.compared[0], 100 * c.compared[1]);
}

void add_plate_table(const GroundComparison& c, HtmlPage& page) {
  const auto row = [](const char* what, const GroundDifference& d) {
    return std::vector<std::string>{what,
                                    fmt::format("{:.1f}", 100 * d.vertical_rms),
                                    fmt::format("{:.1f}", 100 * d.forward_rms),
                                    fmt::format("{:.1f}", 100 * d.sideways_rms),
                                    fmt::format("{:.3f}", d.correlation),
                                    fmt::format("{:.2f} ({:.2f})", d.peak, d.measured_peak)};
  };
  page.add_paragraph(fmt::format(
      "Estimated beside measured, root mean square in % of the body's weight. Plates measured "
      "{:.2f} "
      "weights in the mean; feet land {:+.0f} ms and leave {:+.0f} ms after the plates' times{}.",
      c.measured_mean, 1e3 * c.landing, 1e3 * c.leaving, beside_plates(c)));
  const std::vector<std::string> header{"",         "vertical",          "forwards",
                                        "sideways", "r of the vertical", "peak (plates)"};
  const std::vector<std::vector<std::string>> rows{row("both feet", c.both), row("left", c.feet[0]),
                                                   row("right", c.feet[1])};
  page.add_table(header, rows);
}

void report_plates(const GroundComparison& c, Report& report) {
  for (const auto& [name, d] :
       {std::pair{"both", c.both}, std::pair{"left", c.feet[0]}, std::pair{"right", c.feet[1]}}) {
    const std::string key = std::string("dynamics.plates.") + name;
    report.set(key + ".vertical_rms", d.vertical_rms);
    report.set(key + ".forward_rms", d.forward_rms);
    report.set(key + ".sideways_rms", d.sideways_rms);
    report.set(key + ".correlation", d.correlation);
    report.set(key + ".peak", d.peak);
    report.set(key + ".measured_peak", d.measured_peak);
  }
  report.set("dynamics.plates.measured_mean", c.measured_mean);
  report.set("dynamics.plates.contacts", c.contacts);
  report.set("dynamics.plates.steps_beside", c.beside);
  report.set("dynamics.plates.compared", c.compared[2]);
  report.set("dynamics.plates.landing", c.landing);
  report.set("dynamics.plates.landing_off", c.landing_off);
  report.set("dynamics.plates.leaving", c.leaving);
  report.set("dynamics.plates.leaving_off", c.leaving_off);
}

void add_reserve_table(const Found& found, HtmlPage& page) {
  page.add_paragraph(
      "What muscles do not give of the joints' moments is left to reserves (root mean squares).");
  const std::vector<std::string> header{"joint", "moment, N m", "reserve, N m"};
  std::vector<std::vector<std::string>> rows;
  for (const JointReserve& joint : joint_reserves(*found.efforts))
    rows.push_back({found.skeleton.joints[joint.joint].name, fmt::format("{:.1f}", joint.wanted),
                    fmt::format("{:.2f}", joint.reserve)});
  page.add_table(header, rows);
}

std::string page_of(const Found& found, const std::string& title) {
  const MotionDynamics& d = found.dynamics;
  HtmlPage page("Forces of " + title);
  page.add_paragraph(fmt::format(
      "{:.1f} kg, {} frames at {:.4g} fps, smoothed at {:.3g} Hz. {}", found.inertia.mass,
      d.frames.size(), d.fps, d.cutoff,
      found.plates ? "Joints and residual are with the forces of the plates."
                   : "Ground forces are estimated from the motion, without plates; feet that push "
                     "against each other are not seen."));
  const std::vector<std::string> header{"figure", "value", "of"};
  const std::vector<std::vector<std::string>> rows{
      {"vertical ground reaction, peak", fmt::format("{:.2f}", d.peak_vertical), "weight"},
      {"vertical ground reaction, mean", fmt::format("{:.3f}", d.mean_vertical), "weight"},
      {"residual force, root mean square", fmt::format("{:.3f}", d.residual_force_rms), "weight"},
      {"residual force, peak", fmt::format("{:.3f}", d.residual_force_peak), "weight"},
      {"residual moment, root mean square", fmt::format("{:.4f}", d.residual_moment_rms),
       "weight x height of the centre of mass"},
      {"in flight", fmt::format("{}", d.flight_frames), "frames"},
      {"residual force in flight", fmt::format("{:.3f}", d.flight_residual_rms), "weight"}};
  page.add_table(header, rows);
  if (found.plates) add_plate_table(*found.plates, page);
  add_ground_plots(found, page);
  add_joint_plots(found, page);
  if (found.efforts) {
    add_reserve_table(found, page);
    add_effort_plots(found.anatomy, *found.efforts, found.muscles, page);
  }
  return page.to_string();
}

void report_dynamics(const MotionDynamics& d, Report& report) {
  report.set("dynamics.cutoff", d.cutoff);
  report.set("dynamics.weight", d.weight);
  report.set("dynamics.peak_vertical", d.peak_vertical);
  report.set("dynamics.mean_vertical", d.mean_vertical);
  report.set("dynamics.residual_force_rms", d.residual_force_rms);
  report.set("dynamics.residual_force_peak", d.residual_force_peak);
  report.set("dynamics.residual_moment_rms", d.residual_moment_rms);
  report.set("dynamics.flight_frames", d.flight_frames);
  report.set("dynamics.flight_residual_rms", d.flight_residual_rms);
  report.set("dynamics.center_moved", d.center_moved);
  report.set("dynamics.belt", d.belt.norm());
}

// Spans whose residual force is beyond a share of the weight, "1.20 to 1.35 s", longest first.
std::string doubtful_spans(const MotionDynamics& d, double& share) {
  std::vector<std::pair<std::size_t, std::size_t>> spans;
  std::size_t count = 0;
  for (std::size_t f = 0; f < d.frames.size(); ++f) {
    if (d.frames[f].residual_force.norm() <= kDoubtful * d.weight) continue;
    ++count;
    if (!spans.empty() && double(f - spans.back().second) <= kSpanGap * d.fps)
      spans.back().second = f;
    else
      spans.emplace_back(f, f);
  }
  share = double(count) / double(d.frames.size());
  std::ranges::stable_sort(spans, std::greater{}, [](const auto& s) { return s.second - s.first; });
  if (spans.size() > kMostSpans) spans.resize(kMostSpans);
  std::ranges::sort(spans);
  std::string out;
  for (const auto& [begin, end] : spans)
    out += fmt::format("{}{:.2f} to {:.2f} s", out.empty() ? "" : ", ", double(begin) / d.fps,
                       double(end) / d.fps);
  return out;
}

std::string describe_efforts(const MuscleEfforts& efforts, const Skeleton& skeleton) {
  JointReserve worst;
  for (const JointReserve& joint : joint_reserves(efforts))
    if (joint.reserve > worst.reserve) worst = joint;
  return fmt::format(
      "muscles give {:.1f} % of the moments in the mean; the largest reserve is {:.1f} N m of "
      "{:.1f}, {} (root mean squares)",
      100 * (1 - efforts.reserve_share), worst.reserve, worst.wanted,
      skeleton.joints[std::size_t(worst.joint)].name);
}

// weight: the body's, N.
std::string describe_plates(const GroundComparison& c, double weight) {
  return fmt::format(
             "beside the plates: vertical force {:.1f} % of the weight off (RMS; r {:.3f}), peaks "
             "{:.2f} "
             "({:.2f}), forwards {:.1f} %, sideways {:.1f} %; feet land {:+.0f} ms and leave "
             "{:+.0f} ms "
             "after; plates measured {:.2f} weights in the mean, as of a person of {:.0f} kg",
             100 * c.both.vertical_rms, c.both.correlation, c.both.peak, c.both.measured_peak,
             100 * c.both.forward_rms, 100 * c.both.sideways_rms, 1e3 * c.landing, 1e3 * c.leaving,
             c.measured_mean, c.measured_mean * weight / kGravity) +
         beside_plates(c);
}

int run_dynamics(const DynamicsVerbOptions& options, const Common& common, Report& report) {
  if (options.outputs.empty() && options.html.empty() && options.activations.empty())
    throw UsageError(
        "nothing to write: name a table by -o, activations by --activations, or a page of curves "
        "by --html");
  for (const fs::path& output : options.outputs) require_ending(output, {".csv", ".sto", ".mot"});
  if (!options.html.empty()) require_ending(options.html, {".html"});
  if (!options.activations.empty()) require_ending(options.activations, {".csv", ".sto", ".mot"});
  std::vector<fs::path> files = options.outputs;
  files.push_back(options.activations);
  files.push_back(options.html);
  check_outputs(common, files,
                {options.character, options.motion, options.retarget.map_file, options.plates});
  const BoundCharacter bound =
      bind_character(common.assets, open_character(options.character, common, report), report);
  const Character& character = bound.character;
  const std::vector<ChosenMuscles> chosen = choose_muscles(character.anatomy, options.muscles);
  MotionPlace place;
  const Motion motion = open_motion(options.motion, character, bound.binding, options.retarget,
                                    common, report, &place);
  if (motion.frames.size() < 3)
    throw UnfitError(fmt::format("{}: {} frames have no acceleration; at least 3 are needed",
                                 options.motion.string(), motion.frames.size()));
  const SegmentInertia inertia = weigh_character(character, bound.binding, report);
  DynamicsOptions wanted{options.cutoff, !options.no_ground};
  if (!options.plates.empty())
    wanted.measured =
        open_plates(options.plates, character.anatomy.skeleton, motion,
                    {options.plates_start.value_or(place.start), place.scale, place.turn});
  MotionDynamics dynamics;
  {
    const StageTimer timer(report, "dynamics");
    dynamics = inverse_dynamics(character.anatomy.skeleton, inertia.segments,
                                character.body.skin.V.col(1).minCoeff(), motion, wanted);
  }
  report_dynamics(dynamics, report);
  std::optional<GroundComparison> plates;
  if (!wanted.measured.empty()) {
    plates = compare_ground(dynamics, wanted.measured);
    report_plates(*plates, report);
    note(common, describe_plates(*plates, dynamics.weight));
  }
  std::optional<MuscleEfforts> efforts;
  if (!options.activations.empty() || !options.muscles.empty()) {
    const StageTimer timer(report, "activation");
    efforts =
        static_optimization(make_posing_table(character.anatomy), character.anatomy, dynamics);
    report_efforts(*efforts, character.anatomy.skeleton, report);
    note(common, describe_efforts(*efforts, character.anatomy.skeleton));
  }
  const Found found{character.anatomy.skeleton, inertia, dynamics, plates,
                    character.anatomy,          efforts, chosen};
  if (!options.activations.empty()) {
    write_motion_table(options.activations,
                       activation_table(character.anatomy, dynamics, *efforts));
    note(common, fmt::format("{}: activations", options.activations.string()));
  }
  for (const fs::path& output : options.outputs) {
    write_motion_table(output, dynamics_table(found.skeleton, inertia.segments, dynamics,
                                              efforts ? &*efforts : nullptr));
    note(common, fmt::format("{}: {} frames", output.string(), dynamics.frames.size()));
  }
  if (!options.html.empty()) {
    write_file_atomically(options.html, page_of(found, options.motion.filename().string()));
    note(common, fmt::format("{}: curves", options.html.string()));
  }
  note(common,
       fmt::format("{:.1f} kg; vertical ground reaction up to {:.2f} weights, {:.2f} in the mean; "
                   "residual {:.1f} % of the weight, {} of {} frames in the air",
                   inertia.mass, dynamics.peak_vertical, dynamics.mean_vertical,
                   100 * dynamics.residual_force_rms, dynamics.flight_frames,
                   dynamics.frames.size()));
  double doubtful = 0;
  const std::string spans = doubtful_spans(dynamics, doubtful);
  report.set("dynamics.doubtful_share", doubtful);
  if (!spans.empty())
    note(common, fmt::format("not to be trusted: {:.0f} % of the frames miss more than {:.0f} % of "
                             "the weight, most of them {}",
                             100 * doubtful, 100 * kDoubtful, spans));
  return 0;
}

}  // namespace

void add_dynamics_verb(VerbRegistry& registry) {
  auto options = std::make_shared<DynamicsVerbOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "dynamics",
      "The forces behind a motion: ground reaction, joint moments and power, residual",
      "ecorche dynamics anna-anatomy.glb walk.bvh -o walk-forces.csv --html walk-forces.html\n"
      "  ecorche dynamics anna-anatomy.glb walk.bvh --activations walk.sto --html walk.html",
      [options](const Common& common, Report& report) {
        return run_dynamics(*options, common, report);
      });
  verb->add_option("character", options->character,
                   "Character written by `ecorche fit`, or CROWD.glb#NAME")
      ->required();
  verb->add_option("motion", options->motion, kMotionFilesHelp)->required();
  verb->add_option("-o,--output", options->outputs,
                   "Table to write, a row a frame; may be given several times: .csv, .sto, .mot")
      ->allow_extra_args(false);
  verb->add_option("--html", options->html,
                   "Page of curves: ground reaction, moments and power of hip, knee and ankle");
  verb->add_option("--activations", options->activations,
                   "Table of muscle activations to write, a row a frame: .csv, .sto, .mot; what "
                   "muscles do not give is in the table of -o");
  verb->add_option("--muscles", options->muscles,
                   "Muscles with curves on the page, with commas between them; * stands for any "
                   "letters. With --activations those of gait when left out");
  verb->add_option("--cutoff", options->cutoff,
                   "Hz up to which the motion is believed; 0: all of it. Without it 6, or 12 for a "
                   "motion that leaves the ground")
      ->check(between(0, 1000));
  verb->add_flag("--no-ground", options->no_ground,
                 "Nothing outside holds the body: all that it needs is residual");
  CLI::Option* plates = verb->add_option(
      "--plates", options->plates,
      "What force plates measured (OpenSim's .mot, .sto): compared with the estimate, and taken in "
      "its place for the joints");
  verb->add_option("--plates-start", options->plates_start,
                   "Seconds of the plates' clock at the motion's first frame; that of a .trc or "
                   ".c3d when left out")
      ->check(between(-1e6, 1e6))
      ->needs(plates);
  add_motion_options(*verb, options->retarget);
}

}  // namespace ecorche
