// Parts of the body by the names of joints.
#pragma once

#include <string>
#include <string_view>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// `part` is the stem of our own joint's name ("elbow" for LeftForeArm and lowerarm_l, "knee" for
// lShin, "pip2" for index_02_l), or
//   "hip?", "shoulder?"  a name in use for either of two neighbours; the tree must tell (LeftHip,
//                        LeftShoulder)
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

}  // namespace ecorche::inline v1
