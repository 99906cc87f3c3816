// Reads motions of DeepMimic (Peng et al. 2018, 10.1145/3197517.3201311) on the skeleton of their
// character file, and trusts nothing in either.
//
// A frame holds its duration, the root's position and quaternion (w x y z), and for each further
// joint in the character's order a quaternion (spherical), an angle about z (revolute), or nothing
// (fixed). Lengths are metres.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

struct DeepMimicCharacter {
  std::string name;  // of the file, for messages
  std::vector<ClipJoint> joints;
  // #joints: numbers that a frame holds of each; 7 of the root, 4 spherical, 1 revolute, 0 fixed
  std::vector<int> values;
};

// Bones without a joint at their end reach to the far side of their body's shape. Throws
// InputError; UnfitError for kinds of joints that a figure does not have (planar, prismatic).
DeepMimicCharacter parse_deepmimic_character(std::string_view text, const std::string& name);

// Whether a text begins as these JSON files do.
bool is_deepmimic(std::string_view text);

// `fps`: in place of the frames' durations. Throws InputError: no frames, or other numbers than the
// character's joints have.
MotionClip parse_deepmimic(std::string_view text, const std::string& name,
                           const DeepMimicCharacter& character, const std::optional<double>& fps);

}  // namespace ecorche::inline v1
