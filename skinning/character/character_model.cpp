#include "skinning/character/character_model.h"

#include <fmt/format.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/errors.h"
#include "anatomy/files/package_archive.h"
#include "anatomy/muscles/action_line.h"
#include "skinning/bind/painted_weights.h"
#include "skinning/dynamics/soft_tissue.h"
#include "skinning/evaluation/blend_skinning.h"
#include "skinning/evaluation/package_blend.h"

namespace ecorche {

std::optional<BaseSkin> find_base(const TriMesh& skin) try {
  constexpr Eigen::Index kFine = 100000;
  if (skin.V.rows() < kFine) return std::nullopt;
  const BodyPackage package = read_body_package(find_packages());
  BaseSkin base{{Points(package.skin_size, 3), package.triangles}, refine_skin(package)};
  const Triangles& F = base.refinement.F;
  if (base.refinement.map.rows() != skin.V.rows() || F.rows() != skin.F.rows() || F != skin.F)
    return std::nullopt;
  for (int i = 0; i < package.skin_size; ++i)
    base.mesh.V.row(i) = skin.V.row(base.refinement.base_rows[i]);
  return base;
} catch (const InputError&) {
  return std::nullopt;
}

Actor make_actor(Character character, Report& report, const ActorOptions& options) {
  std::optional<BaseSkin> found;
  if (!options.base) found = find_base(character.body.skin);
  const BaseSkin* base = found ? &*found : options.base;
  Actor actor;
  actor.character = std::move(character);
  const Anatomy& anatomy = actor.character.anatomy;
  const TriMesh& skin = actor.character.body.skin;
  PaintedWeights painted;
  if (!options.weights.empty()) {
    painted = read_painted_weights(options.weights, anatomy,
                                   int(base ? base->mesh.V.rows() : skin.V.rows()));
    report.set("weights.painted_vertices", int(painted.vertices.size()));
  }
  PosedAnatomy rest;
  if (options.moves) {
    const StageTimer timer(report, "posing_table");
    actor.table = make_posing_table(anatomy, MuscleContact::yes);
    pose_anatomy(actor.table, anatomy.skeleton, rest_pose(anatomy.skeleton), rest);
  } else {
    forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), rest.X_WJ);
    rest.slices = rest_slices(anatomy);
  }
  const StageTimer timer(report, "anchoring");
  const BindOptions bind{.moves = options.moves};
  actor.binding = base ? bind_skin(anatomy, rest, base->mesh, base->refinement, skin, painted, bind)
                       : bind_skin(anatomy, rest, skin, painted, bind);
  if (options.moves) actor.under = make_under_skin(anatomy, rest, actor.binding);
  return actor;
}

void add_rivals(Actor& actor) {
  const Anatomy& anatomy = actor.character.anatomy;
  PosedAnatomy rest;
  pose_anatomy(actor.table, anatomy.skeleton, rest_pose(anatomy.skeleton), rest);
  actor.rivals = std::make_shared<const RivalSkins>(make_rival_skins(
      read_body_package(find_packages()), anatomy, rest, actor.character.body.skin, actor.binding));
}

void choose_skin(Actor& actor, const std::string& method) {
  const std::optional<SkinMethod> chosen = skin_method(method);
  if (!chosen)
    throw UsageError(
        fmt::format("--skin: '{}' is no way to move a skin; there are lbs, dqs, deltamush, paper, "
                    "anchors and ecorche",
                    method));
  if (!is_ours(*chosen) && !actor.rivals) add_rivals(actor);
  actor.method = *chosen;
}

void move_skin(const Actor& actor, SkinMethod method, ActorFrame& frame,
               std::span<const float> flesh) {
  if (method == SkinMethod::ecorche) {
    deform_over_muscles(actor.binding, actor.under, flesh, frame.posed, frame.skin, frame.under);
  } else if (method == SkinMethod::anchors) {
    deform_skin(actor.binding, frame.posed, frame.skin, Settle::no);
  } else {
    deform_by(*actor.rivals, method, actor.character.anatomy.skeleton, frame.posed, frame.scratch,
              frame.skin);
  }
}

void play_skin(const Actor& actor, const Pose& pose, ActorFrame& frame,
               std::span<const double> activation, std::span<const float> flesh) {
  pose_anatomy(actor.table, actor.character.anatomy.skeleton, pose, frame.posed,
               tbb::this_task_arena::max_concurrency(), activation);
  move_skin(actor, actor.method, frame, flesh);
}

void play(const Actor& actor, const Pose& pose, ActorFrame& frame,
          std::span<const double> activation, std::span<const float> flesh) {
  play_skin(actor, pose, frame, activation, flesh);
  if (actor.method == SkinMethod::ecorche)
    give_way_to_skin(actor.binding, actor.under, actor.table, frame.skin, frame.posed, frame.under);
}

namespace {

// How many joints go beyond their limits, and by how much: {"motion": {"beyond_limits_deg":
// {"ankle_l": 3.1, ...}}}, the worst first.
void report_limits(RetargetReport& found, Report& report) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  std::vector<LimitBreak> breaks = found.limit_breaks;
  std::stable_sort(breaks.begin(), breaks.end(),
                   [](const LimitBreak& a, const LimitBreak& b) { return a.worst > b.worst; });
  report.set("motion.joints_beyond_limits", int(breaks.size()));
  for (const LimitBreak& one : breaks)
    report.set("motion.beyond_limits_deg." + one.joint, one.worst * kDegrees);
  int samples = 0;
  for (const LimitBreak& one : found.limited) samples += one.frames;
  report.set("motion.joints_limited", int(found.limited.size()));
  report.set("motion.samples_limited", samples);
  for (const EndMove& end : found.ends_moved)
    report.set("motion.ends_moved_max." + end.end, end.most);
  for (const MeetingBreak& one : found.parted) {
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
      breaks.size(), worst.joint, worst.worst * kDegrees, worst.worst_frame, worst.frames));
}

// "walk.bvh: 241 frames at 60 fps, in cm, y up, facing +z; 7 contacts, planted feet slide 0.2 mm".
std::string describe_motion(const std::filesystem::path& file, const Motion& motion,
                            const RetargetReport& found) {
  std::string out =
      fmt::format("{}: {} frames at {:.4g} fps, in {}, {} up, facing {}", file.filename().string(),
                  motion.frames.size(), motion.fps,
                  found.unit == "unknown" ? "an unknown unit" : found.unit, found.up, found.facing);
  if (found.own_rig) return out + "; its rig is this body's own and is taken over as it is";
  if (found.same_rest) out += "; its rest pose is ours";
  if (found.contacts.empty()) return out + "; no foot stands";
  return out + fmt::format("; {} contacts, planted feet slide {:.1f} mm", found.contacts.size(),
                           1e3 * found.slide_p95);
}

}  // namespace

Motion open_motion(const std::filesystem::path& file, const Character& character,
                   const MotionOptions& options, const Common& common, Report& report) {
  const StageTimer timer(report, "retarget");
  const BvhMotion source = read_bvh(file, to_read_options(options));
  RetargetOptions placed = to_retarget_options(options);
  if (!placed.sole_height) placed.sole_height = character.body.skin.V.col(1).minCoeff();
  if (placed.keep_apart)
    placed.rounds = measure_rounds(character.anatomy.skeleton, character.body.skin.V);
  RetargetReport found;
  Motion motion = retarget(source, character.anatomy.skeleton, placed, found);
  report.set("motion.frames", int(motion.frames.size()));
  report.set("motion.fps", motion.fps);
  report.set("motion.unit", found.unit);
  report.set("motion.up", std::string(1, found.up));
  report.set("motion.facing", found.facing);
  report.set("motion.scale", found.scale);
  report.set_flag("motion.same_rest", found.same_rest);
  report.set_flag("motion.own_rig", found.own_rig);
  report.set("motion.contacts", int(found.contacts.size()));
  report.set("motion.foot_slide_p95", found.slide_p95);
  report.set("motion.penetration", found.penetration);
  report_limits(found, report);
  note(common, describe_motion(file, motion, found));
  if (common.verbose) note(common, format_matches(found));
  for (const std::string& warning : found.warnings) {
    note(common, "warning: " + warning);
    report.append_text("motion.warnings", warning);
  }
  return motion;
}

}  // namespace ecorche
