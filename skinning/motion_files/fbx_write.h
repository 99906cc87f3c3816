// Writes motions as Autodesk FBX (binary, version 7.4).
//
// The format has no public specification; records and their sense are those that Blender's exporter
// and assimp's reader agree on. A joint is a node of kind LimbNode; turns are curves of Euler
// angles, deg, with a key a frame, straight in between.
#pragma once

#include <string>

#include "skinning/motion_files/bvh_motion.h"

namespace ecorche::inline v1 {

// A motion in metres with y up (to_bvh); the file is in centimetres, as FBX is by custom. The rest
// pose is that of the joints' offsets. `take`: the animation's name. Precondition
// (std::invalid_argument): rotations Z-X-Y, positions of roots alone, samples of all frames.
std::string format_fbx(const BvhMotion& motion, const std::string& take);

}  // namespace ecorche::inline v1
