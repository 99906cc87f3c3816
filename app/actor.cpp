#include "app/actor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/bare_skin.h"
#include "anatomy/errors.h"
#include "anatomy/package.h"
#include "skinning/baseline.h"
#include "skinning/flesh_motion.h"
#include "skinning/linear_rival.h"

namespace ecorche {

std::optional<BaseSkin> find_base(const TriMesh& skin) try {
  constexpr Eigen::Index kFine = 100000;
  if (skin.V.rows() < kFine) return std::nullopt;
  const BodyPackage package = read_body_package(find_packages());
  BaseSkin base{{Points(package.skin_size, 3), package.triangles}, refine_skin(package)};
  const Triangles& F = base.refinement.F;
  if (base.refinement.map.rows() != skin.V.rows() || F.rows() != skin.F.rows() || F != skin.F) return std::nullopt;
  for (int i = 0; i < package.skin_size; ++i) base.mesh.V.row(i) = skin.V.row(base.refinement.base_rows[static_cast<size_t>(i)]);
  return base;
} catch (const InputError&) {
  return std::nullopt;
}

Actor make_actor(Character character, Report& report, const BaseSkin* base) {
  std::optional<BaseSkin> found;
  if (!base) {
    found = find_base(character.body.skin);
    if (found) base = &*found;
  }
  Actor actor;
  actor.character = std::move(character);
  {
    const StageTimer timer(report, "posing_table");
    actor.table = make_posing_table(actor.character.anatomy);
  }
  const StageTimer timer(report, "anchoring");
  PosedAnatomy rest;
  pose_anatomy(actor.table, actor.character.anatomy.skeleton, rest_pose(actor.character.anatomy.skeleton), rest);
  const TriMesh& skin = actor.character.body.skin;
  actor.binding = base ? bind_skin(actor.character.anatomy, rest, base->mesh, base->refinement, skin) : bind_skin(actor.character.anatomy, rest, skin);
  return actor;
}

namespace {

std::shared_ptr<const RivalSkins> rivals_of(const Actor& actor) {
  const Anatomy& anatomy = actor.character.anatomy;
  PosedAnatomy rest;
  pose_anatomy(actor.table, anatomy.skeleton, rest_pose(anatomy.skeleton), rest);
  return std::make_shared<const RivalSkins>(
      make_rival_skins(read_body_package(find_packages()), anatomy, rest, actor.character.body.skin, actor.binding));
}

}  // namespace

void choose_skin(Actor& actor, const std::string& method) {
  const std::optional<SkinMethod> chosen = skin_method(method);
  if (!chosen) throw UsageError(fmt::format("--skin: '{}' is no way to move a skin; there are lbs, dqs, deltamush, paper, anchors and ecorche", method));
  if (!is_ours(*chosen) && !actor.rivals) actor.rivals = rivals_of(actor);
  actor.method = *chosen;
}

void play(const Actor& actor, const Pose& pose, ActorFrame& frame, std::span<const double> activation, std::span<const float> flesh) {
  const Skeleton& skeleton = actor.character.anatomy.skeleton;
  pose_anatomy(actor.table, skeleton, pose, frame.posed, 1, activation);
  if (actor.method == SkinMethod::ecorche) deform_skin(actor.binding, frame.posed, flesh, frame.skin);
  else if (actor.method == SkinMethod::anchors) deform_skin(actor.binding, frame.posed, frame.skin, Settle::no);
  else deform_by(*actor.rivals, actor.method, skeleton, frame.posed, frame.scratch, frame.skin);
}

Body open_body(const std::filesystem::path& file, const BodyPackage& package, const Common& common, Report& report, std::optional<double> unit) {
  if (has_body_notes(file)) return read_body(file);
  BareSkin bare = read_bare_skin(file, package, unit);
  for (const std::string& text : bare.notes) {
    note(common, text);
    report.append_text("body.notes", text);
  }
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

void compare_skins(const Actor& actor, const Motion& motion, Report& report) {
  Actor each = actor;
  try {
    if (!each.rivals) each.rivals = rivals_of(each);
  } catch (const Error& error) {
    report.set("skins.note", error.what());
  }
  const TriMesh& rest = actor.character.body.skin;
  ActorFrame frame;
  for (const SkinMethod method : kSkinMethods) {
    if (!is_ours(method) && !each.rivals) continue;
    each.method = method;
    double flipped = 0, stretch = 0;
    for (const Pose& pose : motion.frames) {
      play(each, pose, frame);
      const SkinQuality quality = measure_skin(rest, each.binding, {}, frame.posed.X_WJ, frame.skin);
      flipped = std::max(flipped, quality.flipped_share);
      stretch = std::max(stretch, quality.stretch_p99);
    }
    const std::string prefix = fmt::format("skins.{}.", short_name(method));
    report.set(prefix + "skin_flipped_share_max", flipped);
    report.set(prefix + "skin_stretch_p99_max", stretch);
  }
}

MotionQuality survey_motion(const Actor& actor, const Motion& motion, const BodyPackage* package, const Activations& activations) {
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

  std::vector<double> efforts;
  for (size_t f = 0; f < motion.frames.size(); ++f) {
    activation_at(activations, static_cast<double>(f) / motion.fps, efforts);
    play(actor, motion.frames[f], frame, efforts);
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

std::vector<std::string> missed_targets(const MotionQuality& quality) {
  constexpr double drift_limit = 0.01, flipped_limit = 1e-3;
  std::vector<std::string> missed;
  if (quality.volume_drift_max > drift_limit)
    missed.push_back(fmt::format("the volume of {} changes by {:.2f} %; at most 1 % was asked", quality.volume_drift_muscle, 100 * quality.volume_drift_max));
  if (quality.not_finite > 0) missed.push_back(fmt::format("{} skin coordinates are not finite", quality.not_finite));
  if (quality.flipped_share_max > flipped_limit)
    missed.push_back(fmt::format("{:.2f} % of the skin's triangles are flipped in frame {}; at most 0.1 % was asked", 100 * quality.flipped_share_max,
                                 quality.flipped_worst_frame));
  if (quality.linear_flipped_share_max && quality.flipped_share_max > *quality.linear_flipped_share_max)
    missed.push_back(fmt::format("{:.2f} % of the skin's triangles are flipped at worst, but {:.2f} % with linear blend skinning",
                                 100 * quality.flipped_share_max, 100 * *quality.linear_flipped_share_max));
  return missed;
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
