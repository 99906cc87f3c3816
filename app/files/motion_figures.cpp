#include "app/files/motion_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "anatomy/errors.h"
#include "skinning/character/frame_pipeline.h"
#include "skinning/evaluation/skin_quality.h"

namespace ecorche {

MotionQuality play_motion(const Actor& actor, const Motion& motion, MotionRun run) {
  std::array<BaselineWorkspace, kFrameSlots> workspaces;
  run.evaluate = [&](const Pose& pose, const FrameInputs& inputs, int slot, CharacterState& state) {
    evaluate(actor, pose, inputs, state, workspaces[slot]);
  };
  const CharacterModel& model = actor;
  return play_motion(model, motion, static_cast<const MotionRun&>(run));
}

void compare_skins(const Assets& assets, const Actor& actor, const Motion& motion, Report& report) {
  Actor with = actor;
  try {
    if (!with.baselines) add_baselines(assets, with);
  } catch (const Error& error) {
    report.set("skins.note", error.what());
  }
  const TriMesh& rest = actor.character.body.skin;
  const Skeleton& skeleton = actor.character.anatomy.skeleton;
  struct Worst {
    double flipped = 0, stretch = 0;
  };
  using Row = std::array<Worst, kSkinMethods.size()>;
  std::vector<ActorState> frames(kFrameSlots, ActorState(actor));
  std::array<Row, kFrameSlots> rows;
  Row worst;
  const auto measured = [&](SkinMethod method) { return is_ours(method) || with.baselines; };
  const auto make = [&](int f, int slot) {
    ActorState& frame = frames[slot];
    pose_muscles(with.muscles, skeleton, motion.frames[f], frame.posed, frame.contact);
    for (size_t k = 0; k < kSkinMethods.size(); ++k) {
      if (!measured(kSkinMethods[k])) continue;
      evaluate_posed_skin(with, kSkinMethods[k], frame);
      const SkinQuality quality =
          measure_skin(rest, *with.skin.blend, {}, frame.posed.X_WJ, frame.skin);
      rows[slot][k] = {quality.flipped_share, quality.stretch_p99};
    }
  };
  const auto end = [&](int, int slot) {
    for (size_t k = 0; k < worst.size(); ++k) {
      worst[k].flipped = std::max(worst[k].flipped, rows[slot][k].flipped);
      worst[k].stretch = std::max(worst[k].stretch, rows[slot][k].stretch);
    }
  };
  for_each_frame(
      int(motion.frames.size()), [](int, int) {}, make, end);
  for (size_t k = 0; k < worst.size(); ++k) {
    if (!measured(kSkinMethods[k])) continue;
    const std::string prefix = fmt::format("skins.{}.", short_name(kSkinMethods[k]));
    report.set(prefix + "skin_flipped_share_max", worst[k].flipped);
    report.set(prefix + "skin_stretch_p99_max", worst[k].stretch);
  }
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
