// What to say of a joint that a character has not.
#pragma once

#include <string>
#include <string_view>

#include "anatomy/skeleton.h"

namespace ecorche {

// "'elbwo_l' is no joint of this character; did you mean elbow_l?", and where their names are
// listed.
std::string no_such_joint(const Skeleton& skeleton, std::string_view name);

}  // namespace ecorche
