#include "app/files/open_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/limits.h"
#include "app/files/open_markers.h"
#include "skinning/motion_files/joint_angle_table.h"
#include "skinning/motion_files/opensim_read.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/rest_alignment.h"
#include "skinning/retarget/retarget.h"
#include "skinning/rigs/own_motion.h"

namespace ecorche {
namespace {

// Joints that go beyond their limits, and by how much: {"motion": {"beyond_limits_deg":
// {"ankle_l": 3.1, ...}}}, the worst first.
void report_limits(RetargetReport& found, Report& report) {
  std::vector<LimitBreak> breaks = found.limit_breaks;
  std::stable_sort(breaks.begin(), breaks.end(),
                   [](const LimitBreak& a, const LimitBreak& b) { return a.worst > b.worst; });
  report.set("motion.joints_beyond_limits", int(breaks.size()));
  for (const LimitBreak& one : breaks)
    report.set("motion.beyond_limits_deg." + one.joint, one.worst * kDegreesPerRadian);
  int samples = 0;
  for (const LimitBreak& one : found.limit_breaks_before) samples += one.frames;
  report.set("motion.joints_limited", int(found.limit_breaks_before.size()));
  report.set("motion.samples_limited", samples);
  for (const EndMove& end : found.ends_moved)
    report.set("motion.ends_moved_max." + end.end, end.most);
  for (const Penetration& one : found.self_collisions) {
    std::string name = "motion.parted." + one.what;
    std::replace(name.begin(), name.end(), ' ', '_');
    report.set(name + ".frames", one.frames);
    report.set(name + ".before", one.worst);
    report.set(name + ".left", one.left);
    found.warnings.push_back(
        fmt::format("{} passed through each other in {} frames, by up to {:.0f} mm (frame {}); "
                    "they are kept apart, --no-apart lets them",
                    one.what, one.frames, 1e3 * one.worst, one.worst_frame));
  }
  if (breaks.empty()) return;
  const LimitBreak& worst = breaks.front();
  found.warnings.push_back(fmt::format(
      "{} joints go beyond their limits in some frame; the worst, {}, by {:.1f} deg in frame {} "
      "({} frames); "
      "--limits clamp brings them back",
      breaks.size(), worst.joint, worst.worst * kDegreesPerRadian, worst.worst_frame,
      worst.frames));
}

// How often the recording stands still, is empty, has spikes: {"motion": {"faults": {"still": 2,
// ...
void report_faults(const std::vector<RecordingFault>& faults, Report& report) {
  int counts[3] = {};
  for (const RecordingFault& fault : faults) ++counts[std::size_t(fault.kind)];
  report.set("motion.faults.still", counts[0]);
  report.set("motion.faults.empty", counts[1]);
  report.set("motion.faults.spikes", counts[2]);
}

// "walk.bvh: 241 frames at 60 fps, in cm, y up, facing +z; 7 contacts, planted feet slide 0.2 mm".
std::string describe_motion(const std::filesystem::path& file, const Motion& motion,
                            const RetargetReport& found) {
  std::string out =
      fmt::format("{}: {} frames at {:.4g} fps, in {}, {} up, facing {}", file.filename().string(),
                  motion.frames.size(), motion.fps,
                  found.unit == "unknown" ? "an unknown unit" : found.unit, found.up, found.facing);
  if (found.matching_rig) return out + "; its rig is this body's own and is taken over as it is";
  if (found.same_rest) out += "; its rest pose is ours";
  if (found.contacts.empty()) return out + "; no foot stands";
  return out + fmt::format("; {} contacts, planted feet slide {:.1f} mm", found.contacts.size(),
                           1e3 * found.slide_p95);
}

// What the report says of a file whose coordinates the registration of its mesh has told.
void describe_source(const OwnSkin& own, const Skeleton& skeleton, RetargetReport& found) {
  const auto axis_name = [&](const Vec3& direction) {
    int axis = 0;
    const Vec3 in_file = own.axes.transpose() * direction;
    in_file.cwiseAbs().maxCoeff(&axis);
    return fmt::format("{}{}", in_file[axis] < 0 ? '-' : '+', "xyz"[axis]);
  };
  found.up = axis_name(Vec3::UnitY())[1];
  found.facing = axis_name(Vec3::UnitZ());
  const std::vector<Vec3> rest = rest_positions(skeleton);
  const auto at = [&](const char* name) { return rest[std::size_t(find_joint(skeleton, name))]; };
  found.source_leg =
      ((at("knee_l") - at("hip_l")).norm() + (at("ankle_l") - at("knee_l")).norm()) / own.scale;
  std::tie(found.unit, found.metres_per_unit) = guess_unit(found.source_leg);
  found.scale = own.scale;
}

// None where the motion is not of the own skin's joints, or people say how to read it.
std::optional<Motion> open_own_motion(const std::filesystem::path& file, const Character& character,
                                      const Binding& binding, const MotionOptions& options,
                                      const RetargetOptions& placed, RetargetReport& found) {
  if (is_marker_file(file)) return std::nullopt;
  if (!character.own || !options.map_file.empty() || !options.up.empty() || !is_scene_motion(file))
    return std::nullopt;
  const std::string name = printable(file.string());
  const Skeleton& skeleton = character.anatomy.skeleton;
  const MotionReadOptions read = to_read_options(options);
  std::optional<OwnMotion> own =
      own_motion(read_scene_motion(file), name, {read.fps, read.take}, *character.own, skeleton,
                 character.body.skin.V, binding.joint_weights, file.parent_path());
  if (!own) return std::nullopt;
  cut_motion(read.range, name, own->motion);
  found.warnings = std::move(own->warnings);
  describe_source(*character.own, skeleton, found);
  constrain_own_motion(name, skeleton, placed, own->motion, found);
  return std::move(own->motion);
}

// None where the file is no table of our own joints' angles, or people say how to read it.
std::optional<Motion> open_own_angles(const std::filesystem::path& file, const Character& character,
                                      const MotionOptions& options, const RetargetOptions& placed,
                                      RetargetReport& found) {
  const std::string ending = file.extension().string();
  const MotionReadOptions read = to_read_options(options);
  if ((ending != ".mot" && ending != ".sto") || !options.map_file.empty() || !options.up.empty() ||
      !read.take.empty() || !read.skeleton.empty())
    return std::nullopt;
  const std::string name = printable(file.filename().string());
  const CoordinateTable table =
      parse_coordinates(read_input_file(file, limits::kMotionBytes), name);
  if (!has_own_angles(table)) return std::nullopt;
  const Skeleton& skeleton = character.anatomy.skeleton;
  found.warnings = table.warnings;
  Motion motion = motion_of_angles(table, skeleton, read.fps, found.warnings);
  cut_motion(read.range, name, motion);
  found.unit = "m";
  found.facing = "+z";
  constrain_own_motion(name, skeleton, placed, motion, found);
  return motion;
}

MotionClip read_clip(const std::filesystem::path& file, const Character& character,
                     const MotionOptions& options, const Common& common, Report& report,
                     double& start) {
  if (is_marker_file(file)) return open_markers(file, character, options, common, report, start);
  if (!options.markers.empty())
    throw UsageError(printable(file.string()) +
                     ": --markers: it holds no markers; .trc and .c3d do");
  return read_motion(file, to_read_options(options));
}

// Retargeted; `start`: s, of the first frame by the file's clock.
Motion placed_motion(const std::filesystem::path& file, const Character& character,
                     const Binding& binding, const MotionOptions& options, const Common& common,
                     Report& report, RetargetReport& found, double& start) {
  const SecondMotion second = [&](const std::filesystem::path& other) {
    Report aside;
    RetargetReport ignored;
    MotionOptions plain;
    plain.limits = options.limits;
    plain.through = options.through;
    plain.free_feet = options.free_feet;
    plain.plant_feet = options.plant_feet;
    double begin = 0;
    Motion motion = placed_motion(other, character, binding, plain, common, aside, ignored, begin);
    return FilteredMotion{.motion = std::move(motion), .contacts = std::move(ignored.contacts)};
  };
  RetargetOptions placed = to_retarget_options(options, second);
  measure_body(character.anatomy.skeleton, character.body.skin.V, placed);
  if (std::optional<Motion> own = open_own_motion(file, character, binding, options, placed, found))
    return std::move(*own);
  if (std::optional<Motion> own = open_own_angles(file, character, options, placed, found))
    return std::move(*own);
  return retarget(read_clip(file, character, options, common, report, start),
                  character.anatomy.skeleton, placed, found);
}

}  // namespace

Motion open_motion(const std::filesystem::path& file, const Character& character,
                   const Binding& binding, const MotionOptions& options, const Common& common,
                   Report& report, MotionPlace* place) {
  const StageTimer timer(report, "retarget");
  double start = 0;
  RetargetReport found;
  Motion motion = placed_motion(file, character, binding, options, common, report, found, start);
  if (place) *place = {start, found.scale / found.metres_per_unit, found.turn};
  report.set("motion.frames", int(motion.frames.size()));
  report.set("motion.fps", motion.fps);
  report.set("motion.unit", found.unit);
  report.set("motion.up", std::string(1, found.up));
  report.set("motion.facing", found.facing);
  report.set("motion.scale", found.scale);
  report.set("motion.metres_per_unit", found.metres_per_unit);
  report.set_flag("motion.same_rest", found.same_rest);
  report.set_flag("motion.own_rig", found.matching_rig);
  report.set("motion.contacts", int(found.contacts.size()));
  report_faults(found.faults, report);
  report.set("motion.foot_slide_p95", found.slide_p95);
  report.set("motion.penetration", found.penetration);
  report_limits(found, report);
  note(common, describe_motion(file, motion, found));
  if (common.verbose) note(common, format_matches(found.matches));
  for (const std::string& warning : found.warnings) {
    note(common, "warning: " + warning);
    report.append_text("motion.warnings", warning);
  }
  return motion;
}

Motion open_motion(const std::filesystem::path& file, const CharacterModel& model,
                   const MotionOptions& options, const Common& common, Report& report,
                   MotionPlace* place) {
  return open_motion(file, model.character, model.binding, options, common, report, place);
}

MovedActor open_moved_actor(const std::filesystem::path& file, Character character,
                            const ActorOptions& how, const MotionOptions& options,
                            const Common& common, Report& report) {
  std::optional<Motion> early;
  if (!character.own) early = open_motion(file, character, Binding{}, options, common, report);
  MovedActor out;
  out.actor = make_actor(common.assets, std::move(character), report, how);
  out.motion = early ? std::move(*early) : open_motion(file, out.actor, options, common, report);
  return out;
}

}  // namespace ecorche
