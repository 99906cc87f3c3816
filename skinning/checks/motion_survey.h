// A motion played on a character, and what it does to muscles and skin: measured frame by frame,
// summed up, judged. Shared by the verbs animate and demo.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "skinning/character/character_model.h"

namespace ecorche {

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
  bool dynamics = false;  // loose flesh lags
  // for linear blend skinning beside ours, where the skin is its own
  const BodyPackage* package = nullptr;
  std::function<void(int frame, const ActorFrame& played)>
      take{};  // every frame, in order; may be empty
};

// Plays a motion, several frames at once, and measures every frame that it hands over.
MotionQuality play_motion(const Actor& actor, const Motion& motion, const MotionRun& run);

// The same poses by every way to move a skin that there is: flipped triangles and stretch, worst
// frame, under `skins.<method>`. Without the body package or with a skin of another topology only
// our own is measured.
void compare_skins(const Actor& actor, const Motion& motion, Report& report);

// Accuracy targets that a motion misses, with the figures; empty when it meets them all. Exit code
// 8 rests on it.
std::vector<std::string> missed_targets(const MotionQuality& quality);

// Under `prefix`: stable names, see docs/report.md.
void report_quality(const MotionQuality& quality, const std::string& prefix, Report& report);

}  // namespace ecorche
