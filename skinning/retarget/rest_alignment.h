// Rest alignment: rotations of the file's joints -> rotations of ours.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/motion_files/motion_clip.h"
#include "skinning/retarget/joint_mapping.h"

namespace ecorche::inline v1 {

// With R the world rotation of the file's joint, ours is   W * R * from_source[name].
struct RestAlignment {
  Mat3 W = Mat3::Identity();  // the file's world axes -> ours
  // by our joint's name, for each one in JointMapping::rotation_joint
  std::map<std::string, Mat3> from_source;
  std::map<int, Mat3> trunk;  // the same for JointMapping::spine and neck, by the file's joint
  char up = 'y';
  std::string facing;        // "+z": of the reference pose, in the file's axes
  int reference_frame = -1;  // -1: the file's rest pose
  bool same_rest = false;    // the file's rest pose is ours
  double leg = 0;            // hip to ankle along the leg, mean of both, file units
  std::vector<std::string> warnings;
};

// Throws UnfitError when the figure has no legs to speak of or its posture gives no up axis (use
// RetargetOptions::up then).
RestAlignment align_rest(const MotionClip& source, const JointMapping& mapping,
                         const Skeleton& ours, const std::optional<char>& up);

// Unit of length by the leg of a grown person: name and metres, or {"unknown", metres that make the
// leg 0.85 m}.
std::pair<std::string, double> guess_unit(double leg);

}  // namespace ecorche::inline v1
