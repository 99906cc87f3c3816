// Look-up of a joint that our own skeleton must have.
#pragma once

#include <stdexcept>
#include <string>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Its index. Throws std::invalid_argument if it is not there: the skeleton is not ours.
inline int joint_of(const Skeleton& skeleton, const std::string& name) {
  const int j = find_joint(skeleton, name);
  if (j < 0) throw std::invalid_argument("not our skeleton: it has no joint '" + name + "'");
  return j;
}

}  // namespace ecorche::inline v1
