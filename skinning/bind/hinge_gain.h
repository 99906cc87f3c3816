// Gain on the half-way rotations of elbows and knees that keeps the volume of a bent limb. Private
// to the room.
#pragma once

#include <map>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/bind/limb_sections.h"
#include "skinning/bind/skin_weights.h"

namespace ecorche::inline v1 {

// Bends every section's joint to 120 degrees, measures the volume with the pairs' weights as they
// are and doubled, and takes the gain between them at which next to nothing is lost, within
// 1 .. kMostGain. Joint index -> gain. rows: weights of the vertices, pairs with gain 1.
std::map<int, double> find_hinge_gains(const Skeleton& skeleton, const TriMesh& skin,
                                       const std::vector<LimbSection>& sections,
                                       const FrameTables& tables,
                                       const std::vector<WeightRow>& rows);

// Multiplies the weights of the pairs that hinge at these joints.
void apply_hinge_gains(const FrameTables& tables, const std::map<int, double>& gains,
                       std::vector<WeightRow>& rows);

}  // namespace ecorche::inline v1
