// A captured or animated motion of any figure, as every motion file is read: the input of
// retargeting.
//
// Joints, numbers and axes are the file's own; what they mean is decided in retarget/retarget.h. A
// new file format needs a reader that fills a MotionClip, and a line in read_motion.cpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct ClipJoint {
  std::string name;            // unique in the clip, UTF-8
  int parent = -1;             // parents precede children; -1 for a root
  Vec3 offset = Vec3::Zero();  // from the parent in the rest pose, file units
  // Column of a frame's rotations and translations; -1: the joint has none, and keeps the identity
  // or its offset.
  int rotation_track = -1, translation_track = -1;
  std::vector<Vec3> end_sites;  // ends of bones without a joint: offsets from here, file units
};

struct MotionClip {
  std::string name;  // of the file, for messages
  std::vector<ClipJoint> joints;
  double fps = 30;
  int frame_count = 0;  // 0: the rest pose alone
  int rotation_tracks = 0, translation_tracks = 0;
  std::vector<Mat3> rotations;     // frame_count x rotation_tracks; from the parent's axes
  std::vector<Vec3> translations;  // frame_count x translation_tracks; in place of the offset
  // What the file states about its unit of length and its up axis ('x', 'y', 'z'). BVH states
  // neither. Retargeting measures both on the figure and does not read them.
  std::optional<double> metres_per_unit;
  std::optional<char> up;
  // Solved from markers on joints that are ours: of a person who may be of another size and go
  // beyond our limits, whose feet stand as markers tell.
  bool captured = false;
  std::vector<std::string> warnings;
};

// World frames of the clip's joints in the file's units and axes. frame -1 is the rest pose:
// identity rotations, offsets only. `out` is resized once and then reused. Throws
// std::invalid_argument for another frame than -1 .. frame_count - 1.
void clip_kinematics(const MotionClip& clip, int frame, std::vector<Transform>& out);

}  // namespace ecorche::inline v1
