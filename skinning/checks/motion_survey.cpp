#include "skinning/checks/motion_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "anatomy/errors.h"
#include "skinning/character/frame_pipeline.h"
#include "skinning/dynamics/soft_tissue.h"
#include "skinning/evaluation/package_blend.h"
#include "skinning/evaluation/skin_quality.h"

namespace ecorche {
namespace {

// What frames are measured against.
struct MotionSurvey {
  const Actor* actor = nullptr;
  std::vector<SliceRange> ranges;
  std::vector<LimbSection> sections;
  std::vector<double> rest_volumes;  // #muscles, m^3
  std::optional<LinearRival> rival;
};

struct FrameQuality {
  double volume_drift = 0;
  int drift_muscle = -1;
  int clamped = 0;
  SkinQuality skin;
  std::optional<SkinQuality> linear;
};

MotionSurvey begin_survey(const Actor& actor, const BodyPackage* package) {
  const Anatomy& anatomy = actor.character.anatomy;
  const TriMesh& skin = actor.character.body.skin;
  MotionSurvey survey;
  survey.actor = &actor;
  survey.ranges = slice_ranges(anatomy);
  survey.sections = limb_sections(anatomy.skeleton, skin, actor.binding);
  if (package && skin.V.rows() == package->skin_size)
    survey.rival = make_linear_rival(*package, anatomy.skeleton, skin);
  PosedAnatomy rest;
  pose_anatomy(actor.table, anatomy.skeleton, rest_pose(anatomy.skeleton), rest);
  for (size_t m = 0; m < anatomy.muscles.size(); ++m)
    survey.rest_volumes.push_back(muscle_volume(rest, survey.ranges, int(m)));
  return survey;
}

// A frame's skin that is not near its body means that something in character or motion is none of a
// body's; it is not handed on.
void check_near(const ActorFrame& frame, int f) {
  constexpr float kFarthest = 10;  // m from the root
  const Eigen::Vector3f root = frame.posed.X_WJ[0].translation().cast<float>();
  const std::vector<float>& places = frame.skin.positions;
  for (size_t v = 0; v + 3 < places.size(); v += 4)
    for (int k = 0; k < 3; ++k)
      if (const float way = places[v + k] - root[k]; !(way >= -kFarthest && way <= kFarthest))
        throw UnfitError(
            fmt::format("frame {}: skin vertex {} is moved {:.3g} m away from its body; the "
                        "character or the motion is damaged",
                        f, v / 4, way));
}

FrameQuality survey_frame(const MotionSurvey& survey, const ActorFrame& frame, SkinFrame& linear) {
  const Actor& actor = *survey.actor;
  const TriMesh& rest = actor.character.body.skin;
  FrameQuality out;
  for (size_t m = 0; m < survey.rest_volumes.size(); ++m) {
    const double drift =
        std::abs(muscle_volume(frame.posed, survey.ranges, int(m)) / survey.rest_volumes[m] - 1);
    if (drift <= out.volume_drift || std::isnan(out.volume_drift)) continue;
    out.volume_drift = drift;
    out.drift_muscle = int(m);
  }
  out.clamped = frame.posed.clamped;
  out.skin = measure_skin(rest, actor.binding, survey.sections, frame.posed.X_WJ, frame.skin);
  if (survey.rival) {
    deform_rival(*survey.rival, actor.character.anatomy.skeleton, frame.posed.X_WJ, linear);
    out.linear = measure_skin(rest, actor.binding, survey.sections, frame.posed.X_WJ, linear);
  }
  return out;
}

void add_frame(const MotionSurvey& survey, const FrameQuality& frame, int frames,
               MotionQuality& quality) {
  if (!(frame.volume_drift <= quality.volume_drift_max) && !std::isnan(quality.volume_drift_max)) {
    quality.volume_drift_max = frame.volume_drift;
    quality.volume_drift_muscle = survey.actor->character.anatomy.muscles[frame.drift_muscle].name;
  }
  quality.strips_clamped_max = std::max(quality.strips_clamped_max, frame.clamped);
  if (frame.skin.flipped_share > quality.flipped_share_max) {
    quality.flipped_share_max = frame.skin.flipped_share;
    quality.flipped_worst_frame = quality.frames;
  }
  quality.flipped_share_mean += frame.skin.flipped_share / frames;
  quality.stretch_p99_max = std::max(quality.stretch_p99_max, frame.skin.stretch_p99);
  quality.not_finite += frame.skin.not_finite;
  if (frame.linear) {
    quality.linear_flipped_share_max =
        std::max(quality.linear_flipped_share_max.value_or(0), frame.linear->flipped_share);
    quality.linear_flipped_share_mean =
        quality.linear_flipped_share_mean.value_or(0) + frame.linear->flipped_share / frames;
    quality.linear_stretch_p99_max =
        std::max(quality.linear_stretch_p99_max.value_or(0), frame.linear->stretch_p99);
  }
  ++quality.frames;
}

}  // namespace

MotionQuality play_motion(const Actor& actor, const Motion& motion, const MotionRun& run) {
  const Skeleton& skeleton = actor.character.anatomy.skeleton;
  const MotionSurvey survey = begin_survey(actor, run.package);
  const FleshTables flesh =
      run.dynamics ? make_flesh_tables(actor.binding, actor.character.anatomy) : FleshTables{};
  FleshState state;
  struct Slot {
    std::vector<double> efforts;
    std::vector<float> flesh;
    ActorFrame frame;
    SkinFrame linear;
    FrameQuality quality;
  };
  std::array<Slot, kFrameSlots> slots;
  const auto at = [&](int slot) -> Slot& { return slots[slot]; };
  const auto begin = [&](int f, int slot) {  // flesh lags behind the frames before
    const double seconds = f / motion.fps;
    activation_at(run.activations, seconds, at(slot).efforts);
    if (flesh.vertices.empty()) return;
    move_flesh(flesh, skeleton, motion, run.activations, seconds, state);
    at(slot).flesh = state.seen;
  };
  const auto make = [&](int f, int slot) {
    play(actor, motion.frames[f], at(slot).frame, at(slot).efforts, at(slot).flesh);
    check_near(at(slot).frame, f);
    at(slot).quality = survey_frame(survey, at(slot).frame, at(slot).linear);
  };
  MotionQuality quality;
  const int frames = motion.frames.size();
  const auto end = [&](int f, int slot) {
    add_frame(survey, at(slot).quality, frames, quality);
    if (run.take) run.take(f, at(slot).frame);
  };
  each_frame(frames, begin, make, end);
  return quality;
}

void compare_skins(const Actor& actor, const Motion& motion, Report& report) {
  Actor with = actor;
  try {
    if (!with.rivals) add_rivals(with);
  } catch (const Error& error) {
    report.set("skins.note", error.what());
  }
  const TriMesh& rest = actor.character.body.skin;
  const Skeleton& skeleton = actor.character.anatomy.skeleton;
  struct Worst {
    double flipped = 0, stretch = 0;
  };
  using Row = std::array<Worst, kSkinMethods.size()>;
  std::array<ActorFrame, kFrameSlots> frames;
  std::array<Row, kFrameSlots> rows;
  Row worst;
  const auto measured = [&](SkinMethod method) { return is_ours(method) || with.rivals; };
  const auto make = [&](int f, int slot) {
    ActorFrame& frame = frames[slot];
    pose_anatomy(with.table, skeleton, motion.frames[f], frame.posed);
    for (size_t k = 0; k < kSkinMethods.size(); ++k) {
      if (!measured(kSkinMethods[k])) continue;
      move_skin(with, kSkinMethods[k], frame);
      const SkinQuality quality =
          measure_skin(rest, with.binding, {}, frame.posed.X_WJ, frame.skin);
      rows[slot][k] = {quality.flipped_share, quality.stretch_p99};
    }
  };
  const auto end = [&](int, int slot) {
    for (size_t k = 0; k < worst.size(); ++k) {
      worst[k].flipped = std::max(worst[k].flipped, rows[slot][k].flipped);
      worst[k].stretch = std::max(worst[k].stretch, rows[slot][k].stretch);
    }
  };
  each_frame(
      int(motion.frames.size()), [](int, int) {}, make, end);
  for (size_t k = 0; k < worst.size(); ++k) {
    if (!measured(kSkinMethods[k])) continue;
    const std::string prefix = fmt::format("skins.{}.", short_name(kSkinMethods[k]));
    report.set(prefix + "skin_flipped_share_max", worst[k].flipped);
    report.set(prefix + "skin_stretch_p99_max", worst[k].stretch);
  }
}

std::vector<std::string> missed_targets(const MotionQuality& quality) {
  constexpr double drift_limit = 0.01, flipped_limit = 1e-3;
  std::vector<std::string> missed;
  if (quality.volume_drift_max > drift_limit)
    missed.push_back(fmt::format("the volume of {} changes by {:.2f} %; at most 1 % was asked",
                                 quality.volume_drift_muscle, 100 * quality.volume_drift_max));
  if (quality.not_finite > 0)
    missed.push_back(fmt::format("{} skin coordinates are not finite", quality.not_finite));
  if (quality.flipped_share_max > flipped_limit)
    missed.push_back(fmt::format(
        "{:.2f} % of the skin's triangles are flipped in frame {}; at most 0.1 % was asked",
        100 * quality.flipped_share_max, quality.flipped_worst_frame));
  if (quality.linear_flipped_share_max &&
      quality.flipped_share_max > *quality.linear_flipped_share_max)
    missed.push_back(
        fmt::format("{:.2f} % of the skin's triangles are flipped at worst, but {:.2f} % with "
                    "linear blend skinning",
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
