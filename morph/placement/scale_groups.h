// The measures of a group of bones that a hand may change, on top of what a skin says of them.
//
// They are the eleven ways in which a BoneMap shapes a bone, beside the slopes of its joint
// surfaces. A group keeps its place at the joint that it begins at; all that hangs on it goes along
// with its other end.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "morph/placement/bone_groups.h"
#include "morph/placement/fitted_skeleton.h"

namespace ecorche::inline v1 {

struct GroupMeasure {
  const char* name;
  BoneMap::Way way;
  bool factor;  // a factor, of which the map has the logarithm; else a length, m
  const char* help;
};
inline constexpr int kGroupMeasures = 11;
const std::array<GroupMeasure, kGroupMeasures>& group_measures();

struct GroupScale {
  std::string group;  // of data/bone_groups.csv
  // by measure: factors (1: as it is), lengths in m (0: as it is)
  std::array<double, kGroupMeasures> values = unchanged();

  static std::array<double, kGroupMeasures> unchanged();
};

// Changes the maps of both sides. `source`: what the maps carry. Precondition: the rules have the
// groups; throws UnfitError otherwise.
void scale_groups(const std::vector<GroupScale>& scales, const FitRules& rules,
                  const Anatomy& source, SidedPlacement& placement);

}  // namespace ecorche::inline v1
