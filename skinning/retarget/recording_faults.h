// Faults of a recording, which are told and not mended: drop-outs and spikes.
#pragma once

#include <string>
#include <vector>

#include "skinning/motion_files/motion_clip.h"
#include "skinning/retarget/joint_mapping.h"

namespace ecorche::inline v1 {

// A run of frames in which nothing moves, or all angles are nought, or a joint that turns faster
// from one frame to the next than any body turns it.
struct RecordingFault {
  enum class Kind { still, empty, spike };
  Kind kind;
  int first = 0, last = 0;  // frames, from 0; of a spike those between which it turns
  std::string joint{};      // of a spike: our joint's name
  double speed = 0;         // of a spike, rad/s
};

// In the order of their frames. Still: 0.1 s and three frames at least, between frames that move:
// at its ends a motion may wait. `begin`: frames before it are left out (a marker pose).
std::vector<RecordingFault> find_faults(const MotionClip& clip, const JointMapping& mapping,
                                        int begin = 0);

// A line for people of each kind that there is: how often, and where it is worst, in frames that
// --from and --to understand.
std::vector<std::string> describe_faults(const std::string& name, double fps,
                                         const std::vector<RecordingFault>& faults);

}  // namespace ecorche::inline v1
