#include "app/actor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/bare_skin.h"
#include "skinning/baseline.h"
#include "skinning/linear_rival.h"

namespace ecorche {

Actor make_actor(Character character, Report& report) {
  Actor actor;
  actor.character = std::move(character);
  {
    const StageTimer timer(report, "posing_table");
    actor.table = make_posing_table(actor.character.anatomy);
  }
  const StageTimer timer(report, "anchoring");
  actor.binding = bind_skin(actor.character.anatomy, actor.character.body);
  return actor;
}

void play(const Actor& actor, const Pose& pose, ActorFrame& frame) {
  pose_anatomy(actor.table, actor.character.anatomy.skeleton, pose, frame.posed);
  deform_skin(actor.binding, frame.posed, frame.skin);
}

Body open_body(const std::filesystem::path& file, const BodyPackage& package, Report& report) {
  if (has_body_notes(file)) return read_body(file);
  BareSkin bare = read_bare_skin(file, package);
  for (const std::string& text : bare.notes) report.append_text("body.notes", text);
  report.set("body.unit", bare.unit);
  report.set("body.up", bare.up);
  report.set("body.front", bare.front);
  return std::move(bare.body);
}

namespace {

// How many joints go beyond their limits, and by how much: {"motion": {"beyond_limits_deg": {"ankle_l": 3.1, ...}}}, the worst first.
void report_limits(RetargetReport& found, Report& report) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  std::vector<LimitBreak> breaks = found.limit_breaks;
  std::stable_sort(breaks.begin(), breaks.end(), [](const LimitBreak& a, const LimitBreak& b) { return a.worst > b.worst; });
  report.set("motion.joints_beyond_limits", static_cast<int>(breaks.size()));
  for (const LimitBreak& one : breaks) report.set("motion.beyond_limits_deg." + one.joint, one.worst * kDegrees);
  if (breaks.empty()) return;
  const LimitBreak& worst = breaks.front();
  found.warnings.push_back(fmt::format("{} joints go beyond their limits in some frame; the worst, {}, by {:.1f} deg in frame {} ({} frames); "
                                       "--limits clamp brings them back",
                                       breaks.size(), worst.joint, worst.worst * kDegrees, worst.worst_frame, worst.frames));
}

}  // namespace

Motion open_motion(const std::filesystem::path& file, const Character& character, const RetargetOptions& options, const Common& common,
                   Report& report) {
  const StageTimer timer(report, "retarget");
  const BvhMotion source = read_bvh(file);
  RetargetOptions placed = options;
  if (!placed.sole_height) placed.sole_height = character.body.skin.V.col(1).minCoeff();
  RetargetReport found;
  Motion motion = retarget(source, character.anatomy.skeleton, placed, found);
  report.set("motion.frames", static_cast<int>(motion.frames.size()));
  report.set("motion.fps", motion.fps);
  report.set("motion.unit", found.unit);
  report.set("motion.up", std::string(1, found.up));
  report.set("motion.facing", found.facing);
  report.set("motion.scale", found.scale);
  report.set_flag("motion.same_rest", found.same_rest);
  report.set("motion.contacts", static_cast<int>(found.contacts.size()));
  report.set("motion.foot_slide_p95", found.slide_p95);
  report.set("motion.penetration", found.penetration);
  report_limits(found, report);
  for (const std::string& warning : found.warnings) {
    note(common, "warning: " + warning);
    report.append_text("motion.warnings", warning);
  }
  return motion;
}

MotionQuality survey_motion(const Actor& actor, const Motion& motion, const BodyPackage* package) {
  const Anatomy& anatomy = actor.character.anatomy;
  const TriMesh& rest = actor.character.body.skin;
  const auto ranges = slice_ranges(anatomy);
  const auto sections = limb_sections(anatomy.skeleton, rest, actor.binding);
  std::optional<LinearRival> rival;
  if (package && rest.V.rows() == package->skin_size) rival = make_linear_rival(*package, anatomy.skeleton, rest);

  MotionQuality quality;
  ActorFrame frame;
  SkinFrame linear;
  play(actor, rest_pose(anatomy.skeleton), frame);
  std::vector<double> rest_volumes;
  for (size_t m = 0; m < anatomy.muscles.size(); ++m) rest_volumes.push_back(muscle_volume(frame.posed, ranges, static_cast<int>(m)));

  for (size_t f = 0; f < motion.frames.size(); ++f) {
    play(actor, motion.frames[f], frame);
    for (size_t m = 0; m < anatomy.muscles.size(); ++m) {
      const double drift = std::abs(muscle_volume(frame.posed, ranges, static_cast<int>(m)) / rest_volumes[m] - 1);
      if (!(drift <= quality.volume_drift_max)) {
        quality.volume_drift_max = drift;
        quality.volume_drift_muscle = anatomy.muscles[m].name;
      }
    }
    quality.strips_clamped_max = std::max(quality.strips_clamped_max, frame.posed.clamped);
    const SkinQuality ours = measure_skin(rest, actor.binding, sections, frame.posed.X_WJ, frame.skin);
    if (ours.flipped_share > quality.flipped_share_max) {
      quality.flipped_share_max = ours.flipped_share;
      quality.flipped_worst_frame = static_cast<int>(f);
    }
    quality.flipped_share_mean += ours.flipped_share / static_cast<double>(motion.frames.size());
    quality.stretch_p99_max = std::max(quality.stretch_p99_max, ours.stretch_p99);
    quality.not_finite += ours.not_finite;
    if (rival) {
      deform_rival(*rival, anatomy.skeleton, frame.posed.X_WJ, linear);
      const SkinQuality theirs = measure_skin(rest, actor.binding, sections, frame.posed.X_WJ, linear);
      quality.linear_flipped_share_max = std::max(quality.linear_flipped_share_max.value_or(0), theirs.flipped_share);
      quality.linear_flipped_share_mean =
          quality.linear_flipped_share_mean.value_or(0) + theirs.flipped_share / static_cast<double>(motion.frames.size());
      quality.linear_stretch_p99_max = std::max(quality.linear_stretch_p99_max.value_or(0), theirs.stretch_p99);
    }
    ++quality.frames;
  }
  return quality;
}

void report_quality(const MotionQuality& quality, const std::string& prefix, Report& report) {
  report.set(prefix + ".frames", quality.frames);
  report.set(prefix + ".muscle_volume_drift_max", quality.volume_drift_max);
  report.set(prefix + ".muscle_volume_drift_worst", quality.volume_drift_muscle);
  report.set(prefix + ".strips_clamped_max", quality.strips_clamped_max);
  report.set(prefix + ".skin_not_finite", quality.not_finite);
  report.set(prefix + ".skin_flipped_share_max", quality.flipped_share_max);
  report.set(prefix + ".skin_flipped_share_mean", quality.flipped_share_mean);
  report.set(prefix + ".skin_flipped_worst_frame", quality.flipped_worst_frame);
  report.set(prefix + ".skin_stretch_p99_max", quality.stretch_p99_max);
  if (!quality.linear_flipped_share_max) return;
  report.set(prefix + ".linear_blend.skin_flipped_share_max", *quality.linear_flipped_share_max);
  report.set(prefix + ".linear_blend.skin_flipped_share_mean", *quality.linear_flipped_share_mean);
  report.set(prefix + ".linear_blend.skin_stretch_p99_max", *quality.linear_stretch_p99_max);
}

}  // namespace ecorche
