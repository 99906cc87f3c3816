#include "app/files/open_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "skinning/constraints/collision_proxies.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"

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

}  // namespace

Motion open_motion(const std::filesystem::path& file, const Character& character,
                   const MotionOptions& options, const Common& common, Report& report) {
  const StageTimer timer(report, "retarget");
  const MotionClip source = read_motion(file, to_read_options(options));
  RetargetOptions placed = to_retarget_options(options);
  if (!placed.sole_height) placed.sole_height = character.body.skin.V.col(1).minCoeff();
  if (placed.avoid_self_collision)
    placed.proxies = measure_proxies(character.anatomy.skeleton, character.body.skin.V);
  RetargetReport found;
  Motion motion = retarget(source, character.anatomy.skeleton, placed, found);
  report.set("motion.frames", int(motion.frames.size()));
  report.set("motion.fps", motion.fps);
  report.set("motion.unit", found.unit);
  report.set("motion.up", std::string(1, found.up));
  report.set("motion.facing", found.facing);
  report.set("motion.scale", found.scale);
  report.set_flag("motion.same_rest", found.same_rest);
  report.set_flag("motion.own_rig", found.matching_rig);
  report.set("motion.contacts", int(found.contacts.size()));
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

}  // namespace ecorche
