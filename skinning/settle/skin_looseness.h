// Strain of the skin by joints: how far they would stretch it between the tissue that follows them.
// Private to the room.
//
// An edge whose ends follow a joint by weights u and v grows, when the joint turns by a small
// angle, by up to angle |u - v| of its distance from the joint. Where that is much for the edge's
// length and the joint's range, as at the corners of the mouth, on knuckles and the tip of an
// elbow, skin is loose and wrinkled however thin it lies on the bone.
#pragma once

#include <span>
#include <vector>

#include "anatomy/skeleton.h"
#include "anatomy/types.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

// m a m, #V: of the edges about a vertex, the largest stretch by any one joint at its limit, taken
// as if lengths grew with angles; at most 3. Precondition: `joint_weights`, #V, name joints of the
// skeleton.
std::vector<double> find_joint_strain(const Skeleton& skeleton, const TriMesh& skin,
                                      std::span<const JointWeights> joint_weights);

}  // namespace ecorche::inline v1
