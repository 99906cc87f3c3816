// What a joint's name says about the part of the body it moves.
#pragma once

#include <string>
#include <string_view>

#include "anatomy/types.h"

namespace ecorche {

// `part` is the stem of our own joint's name ("elbow" for LeftForeArm, lowerarm_l, lShin is "knee",
// index_02_l is "pip2"), or
//   "hip?", "shoulder?"  the name is used for either of two neighbours; the tree must tell
//   (LeftHip, LeftShoulder) "toes"               all toes at once "fingers"            all fingers
//   at once
//   ""                   nothing that is known, or a helper (twist bones, end markers, metacarpals)
struct NamedPart {
  std::string part;
  Side side = Side::middle;
};

// Understands prefixes with ':' or '|', camel case, separators, "left"/"l"/"L" before or after, and
// numbers.
NamedPart named_part(std::string_view joint_name);

}  // namespace ecorche
