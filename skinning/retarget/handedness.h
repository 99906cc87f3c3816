// Files with left-handed axes, and their mirror image.
#pragma once

#include "skinning/motion_files/motion_clip.h"
#include "skinning/retarget/joint_mapping.h"

namespace ecorche::inline v1 {

// Does the figure, its left where its joints' names say, have toes that point backwards and knees
// that bend forwards? Then the file's axes are left-handed, as some programs' are, or its names are
// swapped: no posture tells which. Of the rest pose and up to 100 frames; false where feet and
// knees disagree or tell little.
bool is_mirrored(const MotionClip& clip, const JointMapping& mapping);

// The clip seen in a mirror across its first axis.
MotionClip mirrored(MotionClip clip);

}  // namespace ecorche::inline v1
