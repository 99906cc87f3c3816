// How strongly the half-way rotations at elbows and knees must count for a bent limb to keep its
// volume. Private to the room.
#pragma once

#include <map>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/bind/joint_weights.h"
#include "skinning/evaluation/skin_quality.h"

namespace ecorche {

// Bends every section's joint to 120 degrees, measures the volume with the shares as they are and
// doubled, and takes the gain between them at which next to nothing is lost, within 1 .. kMostGain.
// Joint index -> gain. rows: carriers of the vertices, pairs with gain 1.
std::map<int, double> find_hinge_gains(const Skeleton& skeleton, const TriMesh& skin,
                                       const std::vector<LimbSection>& sections,
                                       const SkinTables& tables, const std::vector<ShareRow>& rows);

// Multiplies the shares of the pairs that hinge at these joints.
void apply_hinge_gains(const SkinTables& tables, const std::map<int, double>& gains,
                       std::vector<ShareRow>& rows);

}  // namespace ecorche
