// How much each vertex of a skin belongs to each joint. Private to the room.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/bind/bind.h"
#include "skinning/bind/skin_depth.h"

namespace ecorche {

using ShareRow = std::vector<Influence>;  // rising joint, positive weights, sum 1

// Diffuses the hard labels of the survey over the skin: two screened Poisson solves (M / l^2 + L) w
// = M / l^2 p, whose length l grows with the local radius of the body and the depth of the bone.
// Two solves: the shares are smooth where one alone has a crease. Arms and legs are told from the
// trunk with a shorter length than the vertebrae from each other: a bend of the trunk is spread
// over the whole of it, but a raised arm must not take the flank along. Throws UnfitError when no
// vertex reaches a bone.
std::vector<ShareRow> diffuse_shares(const Skeleton& skeleton, const TriMesh& skin,
                                     const SkinSurvey& survey, double blend_width);

// Drops shares below `least`, smoothly (each loses `least` before the row's own sum is restored),
// and keeps at most `most` a row.
void thin_shares(std::vector<ShareRow>& rows, double least, int most);

}  // namespace ecorche
