#include "skinning/motion_files/motion_clip.h"

#include <fmt/format.h>

#include <stdexcept>

namespace ecorche::inline v1 {

void clip_kinematics(const MotionClip& clip, int frame, std::vector<Transform>& out) {
  if (frame < -1 || frame >= clip.frame_count)
    throw std::invalid_argument(
        fmt::format("clip_kinematics: frame {} of {}", frame, clip.frame_count));
  out.resize(clip.joints.size());
  for (std::size_t j = 0; j < out.size(); ++j) {
    const ClipJoint& joint = clip.joints[j];
    Transform local = Transform::Identity();
    local.translation() = joint.offset;
    if (frame >= 0 && joint.rotation_track >= 0)
      local.linear() =
          clip.rotations[std::size_t(frame) * clip.rotation_tracks + joint.rotation_track];
    if (frame >= 0 && joint.translation_track >= 0)
      local.translation() =
          clip.translations[std::size_t(frame) * clip.translation_tracks + joint.translation_track];
    out[j] = joint.parent < 0 ? local : out[joint.parent] * local;
  }
}

}  // namespace ecorche::inline v1
