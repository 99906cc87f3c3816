// Message about an unknown joint.
#pragma once

#include <string>
#include <string_view>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// "'elbwo_l' is no joint of this character; did you mean elbow_l?", and where their names are
// listed.
std::string no_such_joint(const Skeleton& skeleton, std::string_view name);

}  // namespace ecorche::inline v1
