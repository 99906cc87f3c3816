// How far the joints would stretch the skin between the flesh that follows them. Private to the
// room.
//
// An edge whose ends follow a joint by shares u and v grows, when the joint turns by a small angle,
// by up to angle |u - v| of its distance from the joint. Where that is much for how short the edge
// is and how far the joint goes, as at the corners of the mouth, on knuckles and the tip of an
// elbow, skin is loose and wrinkled however thin it lies on the bone.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/skeleton.h"
#include "anatomy/types.h"
#include "skinning/bind/bind.h"

namespace ecorche {

// m a m, #V: of the edges about a vertex, the most that any one joint stretches at its limit, taken
// as if lengths grew with angles; at most 3. `joint_weights`: #V. Precondition: `joint_weights`
// name joints of the skeleton.
std::vector<double> find_joint_strain(const Skeleton& skeleton, const TriMesh& skin,
                                      std::span<const std::array<Influence, 4>> joint_weights);

}  // namespace ecorche
