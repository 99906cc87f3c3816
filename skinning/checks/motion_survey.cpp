#include "skinning/checks/motion_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/errors.h"
#include "skinning/bind/limb_sections.h"
#include "skinning/character/frame_pipeline.h"
#include "skinning/dynamics/soft_tissue.h"
#include "skinning/evaluation/package_blend.h"
#include "skinning/evaluation/skin_quality.h"

namespace ecorche::inline v1 {
namespace {

// References that frames are measured against.
struct MotionSurvey {
  const CharacterModel* model = nullptr;
  std::vector<SliceRange> ranges;
  std::vector<LimbSection> sections;
  std::vector<double> rest_volumes;  // #muscles, m^3
  std::optional<LinearBaseline> baseline;
};

struct FrameQuality {
  double volume_drift = 0;
  int drift_muscle = -1;
  int clamped = 0;
  SkinQuality skin;
  std::optional<SkinQuality> linear;
};

MotionSurvey begin_survey(const CharacterModel& model, const BodyPackage* package) {
  const Anatomy& anatomy = model.character.anatomy;
  const TriMesh& skin = model.character.body.skin;
  MotionSurvey survey;
  survey.model = &model;
  survey.ranges = slice_ranges(anatomy);
  survey.sections = limb_sections(anatomy.skeleton, skin, model.binding.joint_weights);
  if (package && skin.V.rows() == package->skin_size)
    survey.baseline = make_linear_baseline(*package, anatomy.skeleton, skin);
  PosedAnatomy rest;
  ContactWorkspace contact;
  pose_muscles(model.muscles, anatomy.skeleton, rest_pose(anatomy.skeleton), rest, contact);
  for (size_t m = 0; m < anatomy.muscles.size(); ++m)
    survey.rest_volumes.push_back(muscle_volume(rest, survey.ranges, int(m)));
  return survey;
}

// A frame's skin that is not near its body means that something in character or motion is none of a
// body's; it is not handed on.
void check_near(const CharacterState& frame, int f) {
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

FrameQuality survey_frame(const MotionSurvey& survey, const CharacterState& frame,
                          SkinFrame& linear) {
  const CharacterModel& model = *survey.model;
  const TriMesh& rest = model.character.body.skin;
  FrameQuality out;
  for (size_t m = 0; m < survey.rest_volumes.size(); ++m) {
    const double drift =
        std::abs(muscle_volume(frame.posed, survey.ranges, int(m)) / survey.rest_volumes[m] - 1);
    if (drift <= out.volume_drift || std::isnan(out.volume_drift)) continue;
    out.volume_drift = drift;
    out.drift_muscle = int(m);
  }
  out.clamped = frame.posed.clamped;
  out.skin = measure_skin(rest, *model.skin.blend, survey.sections, frame.posed.X_WJ, frame.skin);
  if (survey.baseline) {
    deform_linear_baseline(*survey.baseline, model.character.anatomy.skeleton, frame.posed.X_WJ,
                           linear);
    out.linear = measure_skin(rest, *model.skin.blend, survey.sections, frame.posed.X_WJ, linear);
  }
  return out;
}

void add_frame(const MotionSurvey& survey, const FrameQuality& frame, int frames,
               MotionQuality& quality) {
  if (!(frame.volume_drift <= quality.volume_drift_max) && !std::isnan(quality.volume_drift_max)) {
    quality.volume_drift_max = frame.volume_drift;
    quality.volume_drift_muscle = survey.model->character.anatomy.muscles[frame.drift_muscle].name;
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

MotionQuality play_motion(const CharacterModel& model, const Motion& motion, const MotionRun& run) {
  const Skeleton& skeleton = model.character.anatomy.skeleton;
  const MotionSurvey survey = begin_survey(model, run.package);
  const SoftTissueTables tissue = run.dynamics ? make_soft_tissue(model) : SoftTissueTables{};
  SoftTissueState state;
  struct Slot {
    explicit Slot(const CharacterModel& model) : frame(model) {}

    std::vector<double> activation;
    std::vector<float> soft_tissue;
    CharacterState frame;
    SkinFrame linear;
    FrameQuality quality;
  };
  std::vector<Slot> slots(kFrameSlots, Slot(model));
  const auto begin = [&](int f, int slot) {  // soft tissue lags behind the frames before
    const double seconds = f / motion.fps;
    activation_at(run.activations, seconds, slots[slot].activation);
    if (tissue.vertices.empty()) return;
    advance_soft_tissue(tissue, skeleton, motion, run.activations, seconds, state);
    slots[slot].soft_tissue = state.offsets;
  };
  const auto make = [&](int f, int slot) {
    Slot& at = slots[slot];
    const FrameInputs inputs{at.activation, at.soft_tissue};
    if (run.evaluate)
      run.evaluate(motion.frames[f], inputs, slot, at.frame);
    else
      evaluate(model, motion.frames[f], inputs, at.frame);
    check_near(at.frame, f);
    at.quality = survey_frame(survey, at.frame, at.linear);
  };
  MotionQuality quality;
  const int frames = motion.frames.size();
  const auto end = [&](int f, int slot) {
    add_frame(survey, slots[slot].quality, frames, quality);
    if (run.take) run.take(f, slots[slot].frame);
  };
  for_each_frame(frames, begin, make, end);
  return quality;
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

}  // namespace ecorche::inline v1
