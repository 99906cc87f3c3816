// Parts of the body by the names of joints.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// `part` is the stem of our own joint's name ("elbow" for LeftForeArm and lowerarm_l, "knee" for
// lShin, "pip2" for index_02_l), or
//   "hip?", "shoulder?"  a name in use for either of two neighbours; the tree must tell (LeftHip,
//                        LeftShoulder)
//   "foot?"              an ankle, or what is beyond one
//   "toes"               all toes together
//   "fingers"            all fingers together
//   ""                   unknown, or a helper (twist bones, end markers, metacarpals)
struct NamedPart {
  std::string part;
  Side side = Side::middle;
};

// Understands prefixes with ':' or '|', camel case, separators, "left"/"l"/"L" before or after, and
// numbers.
NamedPart named_part(std::string_view joint_name);

// The same of all joints of a figure, without what most of them begin with and no side or part is:
// "Character1_", "J_Bip_", "Bip01 ".
std::vector<NamedPart> named_parts(std::span<const std::string> joint_names);

}  // namespace ecorche::inline v1
