// Frames that a recording without times has lost, or holds twice: they are told and not mended.
#pragma once

#include <string>
#include <vector>

#include "skinning/motion_files/motion_clip.h"
#include "skinning/retarget/joint_mapping.h"

namespace ecorche::inline v1 {

// A step from a frame to the next in which the whole figure goes much further than in the steps
// before and after it, or not at all.
struct UnevenStep {
  int frame = 0;        // that it leads to, from 0
  int lost = 0;         // frames that are missing before it; 0: it is the frame before once more
  std::string joint{};  // ours that turns furthest in it, where frames are lost
  double angle = 0;     // by how much, rad
};

// In the order of their frames. Steps of five joints at least have to agree, in median on 1.7 times
// the mean of the two steps beside them, three of four on 1.4 times. Frames that hold still longer
// are find_faults()'s.
std::vector<UnevenStep> find_uneven_steps(const MotionClip& clip, const JointMapping& mapping,
                                          int begin = 0);

// A line for people of lost and one of repeated frames, where there are any, with the frames as
// --from and --to understand them.
std::vector<std::string> describe_uneven_steps(const std::string& name,
                                               const std::vector<UnevenStep>& steps);

}  // namespace ecorche::inline v1
