#include "app/options/motion_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <variant>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "app/options/option_values.h"
#include "skinning/retarget/joint_map_file.h"

namespace ecorche {

void add_skin_option(CLI::App& verb, std::string& method) {
  verb.add_option(
          "--skin", method,
          "How the skin is moved: ecorche; anchors (the same before it settles, faster); or by the "
          "body package's weights lbs, dqs or deltamush, or paper (the nearest part)")
      ->check(one_of({"ecorche", "anchors", "lbs", "dqs", "deltamush", "paper"}))
      ->capture_default_str();
}

void add_weights_option(CLI::App& verb, std::filesystem::path& weights) {
  verb.add_option("--weights", weights,
                  "Table of weights set by hand (CSV: vertex, joint, weight), in place of what is "
                  "found by itself; `ecorche weights` writes one");
}

void add_muscles_option(CLI::App& verb, std::string& muscles) {
  verb.add_option(
          "--muscles", muscles,
          "What carries muscles: map, one smooth map of the body's inside, by which they stay "
          "whole in hard poses; lines, each its own action line; or auto: map with our own skin, "
          "lines with others")
      ->capture_default_str();
}

MuscleMotion to_muscle_motion(const std::string& muscles, const std::string& method) {
  if (muscles == "lines" || (muscles == "auto" && method != "ecorche")) return MuscleMotion::lines;
  if (muscles == "auto") return MuscleMotion::map;
  if (muscles != "map")
    throw UsageError(
        fmt::format("--muscles: '{}' is none; there are auto, map and lines", muscles));
  if (method != "ecorche")
    throw UsageError(
        fmt::format("--muscles map: with --skin {} muscles move by their lines; leave one of them "
                    "out",
                    method));
  return MuscleMotion::map;
}

void add_dynamics_option(CLI::App& verb, bool& dynamics) {
  verb.add_flag("--dynamics", dynamics,
                "Let loose flesh lag and settle; less over muscles that work (--activation)");
}

void require_settling(bool dynamics, const std::string& method) {
  if (dynamics && method != "ecorche")
    throw UsageError("--dynamics: only our own skin has flesh that lags; leave --skin out");
}

void add_definition_option(CLI::App& verb, std::optional<double>& definition,
                           const std::string& otherwise) {
  verb.add_option(
          "--definition", definition,
          "How much muscles, tendons and bones show through the fine skin: 0 nothing, 1 all "
          "that the fat over them lets through. When left out: " +
              otherwise)
      ->check(between(0.0, 1.0));
}

std::optional<double> to_definition(const std::optional<double>& definition,
                                    const std::string& method) {
  if (method == "ecorche") return definition;
  if (definition && *definition > 0)
    throw UsageError("--definition: only our own skin shows the anatomy; leave --skin out");
  return 0;
}

void add_motion_options(CLI::App& verb, MotionOptions& options) {
  verb.add_option("--map", options.map_file,
                  "Which joint is which, where guessing fails: lines `file joint = our joint`");
  verb.add_option("--up", options.up,
                  "Up axis of the file, instead of guessing; for figures that are seldom upright")
      ->check(one_of({"x", "y", "z"}));
  verb.add_option("--markers", options.markers,
                  "Where markers of a .trc or .c3d are stuck that have names of your own: a table "
                  "(CSV: marker, place), places as in data/markers/places.csv");
  verb.add_option("--motion-fps", options.fps,
                  "Frames a second of the file, instead of what it says")
      ->check(between(0.1, 10000));
  verb.add_option(
      "--take", options.take,
      "Of a file with several motions (.glb, .gltf, .fbx, .dae): the name of one, or its "
      "number from 1; the first when left out");
  verb.add_option(
      "--skeleton", options.skeleton,
      "Skeleton of a motion that comes without (.amc: an .asf; DeepMimic: its character); "
      "looked for beside the motion when left out");
  verb.add_option("--limits", options.limits,
                  "What becomes of joints beyond their anatomical limits: kept as they are, "
                  "brought back (clamp), or auto: brought back unless the file's rest pose is ours")
      ->check(one_of({"auto", "keep", "clamp"}))
      ->capture_default_str();
  verb.add_flag(
      "--no-apart", options.through,
      "Let limbs pass through each other, trunk and head where the motion has them do so");
  CLI::Option* free =
      verb.add_flag("--no-plant", options.free_feet, "Leave the feet where the file puts them");
  verb.add_flag("--plant", options.plant_feet,
                "Plant the feet even of a file whose rig is this body's own, which is otherwise "
                "taken over as it is")
      ->excludes(free);
  add_filter_option(verb, options.filters);
}

void add_range_options(CLI::App& verb, MotionOptions& options) {
  verb.add_option(
      "--from", options.from,
      "Where the part of the motion begins that is read: seconds (1.5, 1.5s, 150ms) or a "
      "frame, counted from 1 (36f)");
  verb.add_option("--to", options.to, "Where it ends; this frame is the last one");
}

RetargetOptions to_retarget_options(const MotionOptions& options, const SecondMotion& second) {
  RetargetOptions out;
  if (!options.map_file.empty()) out.joint_map = read_joint_map(options.map_file);
  if (!options.up.empty()) out.up = options.up[0];
  if (options.limits != "auto") out.clamp_limits = options.limits == "clamp";
  out.avoid_self_collision = !options.through;
  if (options.free_feet || options.plant_feet) out.plant_feet = options.plant_feet;
  out.filters = to_filters(
      options.filters, second ? second : [](const std::filesystem::path& file) {
        throw UsageError("--filter blend=" + printable(file.string()) +
                         ": motions of crowds are not blended; name one person, CROWD.glb#NAME");
        return FilteredMotion{};
      });
  const bool locks = std::ranges::any_of(
      out.filters, [](const MotionFilter& one) { return std::holds_alternative<LockFeet>(one); });
  if (locks && options.free_feet)
    throw UsageError("--filter lock: --no-plant leaves the feet where they are; leave one out");
  return out;
}

MotionReadOptions to_read_options(const MotionOptions& options) {
  MotionReadOptions out;
  if (options.fps > 0) out.fps = options.fps;
  out.take = options.take;
  out.skeleton = options.skeleton;
  if (!options.from.empty()) out.range.from = read_moment(options.from, "--from");
  if (!options.to.empty()) out.range.to = read_moment(options.to, "--to");
  return out;
}

}  // namespace ecorche
