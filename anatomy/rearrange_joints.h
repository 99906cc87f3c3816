// Joints of a skeleton hung on others than before.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

using JointParents = std::map<std::string, std::string>;  // by the name of a joint

// Joints keep their order as far as parents come first; places in the world stay. Bones, muscles
// and wraps go with their joints. Throws UnfitError for joints that the anatomy lacks, and for a
// circle.
void rearrange_joints(const JointParents& parents, Anatomy& anatomy);

// Path points and wraps: joint j becomes number[j].
void renumber_joints(std::span<const int> number, std::vector<Muscle>& muscles);

}  // namespace ecorche::inline v1
