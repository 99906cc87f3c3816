// The tree of joints changed: joints taken away with their bones, joints set between others.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

struct JointTreeChange {
  std::vector<std::string> removed;            // by name; what hangs on them has to be removed, too
  std::map<std::string, std::string> parents;  // the new parent of a joint, by names

  bool empty() const { return removed.empty() && parents.empty(); }
};

// Joints keep their order as far as parents come first; places in the world stay. Bones, muscles
// and wraps go with their joints; fascia that only removed bones carry goes with these. Throws
// UnfitError for joints that the anatomy lacks, for a circle, and where a muscle hangs on what is
// removed.
void rearrange_joints(const JointTreeChange& change, Anatomy& anatomy);

}  // namespace ecorche::inline v1
