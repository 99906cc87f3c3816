// Motions in NumPy's archives (.npz): rotations of the joints of the body models that AMASS and its
// like use (Mahmood et al. 2019, 10.1109/ICCV.2019.00554).
//
// `poses` holds axis and angle of each joint, rad, of which only the order is a convention: pelvis
// first, three numbers a joint, 22 joints of a body, 24 with hands, 52 with fingers, or 55 with jaw
// and eyes; `root_orient`, `pose_body` and `pose_hand` are the same in parts. `trans` is the root's
// path, m, `mocap_framerate` (or mocap_frame_rate, fps) the rate. No model's shape is read or
// needed: the figure has limbs of an average person, its arms straight out at rest.
#pragma once

#include <optional>
#include <string>

#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

// Throws InputError: no archive, arrays that are missing, of other shapes or that contradict each
// other; no rate and no `fps`.
MotionClip parse_npz_motion(std::string bytes, const std::string& name,
                            const std::optional<double>& fps);

}  // namespace ecorche::inline v1
