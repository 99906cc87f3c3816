// Reads Acclaim skeletons (.asf) and motions (.amc), and trusts nothing in them.
//
// The format: Schafer, Acclaim Skeleton File Definition V1.10 (1994); Vicon's notes on it.
// Rotations of `order` (root) and `dof` (bones) are taken one after the other about fixed axes,
// those of the root about the world's, those of a bone about its own `axis` frame; the pre-set
// `axis`, `position` and `orientation` of the root likewise. Lengths are inches times the
// skeleton's `length`. An .amc that is not :FULLY-SPECIFIED keeps the values of bones that a frame
// leaves out. What is wrong is an InputError "file:line: part: value; what to do".
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/types.h"
#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

// A bone moves about its beginning, which is the end of its parent.
struct AcclaimBone {
  std::string name;
  int parent = -1;               // parents precede children; -1: the root, bone 0
  Vec3 along = Vec3::Zero();     // from beginning to end, world, file units; the root has none
  Mat3 axis = Mat3::Identity();  // of the frame that it moves in
  std::string channels;          // in the .amc's order: x y z translations, X Y Z rotations
};

struct AcclaimSkeleton {
  std::string name;  // of the file, for messages
  std::vector<AcclaimBone> bones;
  double length = 1;             // inches times this are the file's unit
  double angle = 1;              // rad, of the file's unit of angles
  Vec3 position = Vec3::Zero();  // pre-set, of the root
};

// Throws InputError; LimitError for more than limits::kMotionJoints bones.
AcclaimSkeleton parse_asf(std::string_view text, const std::string& name);

// The motion as joints at the beginnings of the skeleton's bones. `fps`: the rate, which few of
// these files state; 120 with a warning when left out. Throws InputError, also for bones that the
// skeleton does not have; LimitError for more than limits::kMotionFrames.
MotionClip parse_amc(std::string_view text, const std::string& name,
                     const AcclaimSkeleton& skeleton, const std::optional<double>& fps);

}  // namespace ecorche::inline v1
