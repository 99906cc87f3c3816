// A motion played on a character: quality of muscles and skin, measured frame by frame, summed up,
// judged.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/files/assets.h"
#include "skinning/character/evaluate.h"
#include "skinning/motion/activation.h"

namespace ecorche::inline v1 {

// Over all frames of a motion.
struct MotionQuality {
  int frames = 0;
  double volume_drift_max = 0;      // largest relative change of any muscle's volume
  std::string volume_drift_muscle;  // whose
  double flipped_share_max = 0;     // of the skin's triangles, worst frame
  double flipped_share_mean = 0;
  int flipped_worst_frame = 0;
  double stretch_p99_max = 0;
  int not_finite = 0;
  int strips_clamped_max = 0;
  // The same poses with linear blend skinning and the body package's own weights; absent for skins
  // of another topology.
  std::optional<double> linear_flipped_share_max;
  std::optional<double> linear_flipped_share_mean;
  std::optional<double> linear_stretch_p99_max;
};

struct MotionRun {
  const Activations& activations;
  bool dynamics = false;  // soft tissue lags
  // for linear blend skinning beside ours, where the skin is the package's own
  const BodyPackage* package = nullptr;
  // every frame, in order; may be empty
  std::function<void(int frame, const CharacterState& played)> take{};
  // Evaluates a frame in place of evaluate(), for baselines; may be empty. Called by several
  // threads at once, with different slots (see frame_pipeline.h).
  std::function<void(const Pose&, const FrameInputs&, int slot, CharacterState&)> evaluate{};
};

// Plays a motion, several frames at once, and measures every frame that it hands over. Throws
// UnfitError for a frame whose skin is far from its body.
MotionQuality play_motion(const CharacterModel& model, const Motion& motion, const MotionRun& run);

// Accuracy targets that a motion misses, with the figures; empty when it meets them all. Exit code
// 8 rests on it.
std::vector<std::string> missed_targets(const MotionQuality& quality);

}  // namespace ecorche::inline v1
