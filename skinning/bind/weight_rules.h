// What skin does that the bone beneath it does not: it turns gradually along limbs and glides over
// the shoulder blade. Private.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/bind/joint_weights.h"

namespace ecorche {

// Upper arm and thigh: the share of the shoulder (hip) is split between the joint and a carrier
// without its axial rotation, which is all at the shoulder and nothing at the elbow. Forearm: the
// share of ulna and radius passes from one to the other along its length. New carriers are appended
// to `twists`; rows then refer to carriers (#joints + k). `painted`: vertices whose forearm stays
// as it is.
void spread_twist(const Skeleton& skeleton, const TriMesh& skin, std::span<const int> painted,
                  std::vector<ShareRow>& rows, std::vector<TwistCarrier>& twists);

// Away from the acromion the skin of the back stays with the ribs while the shoulder blade slides
// beneath it (30 to 70 mm by upright tomography, 10.3390/s22176502).
void let_scapula_glide(const Skeleton& skeleton, const TriMesh& skin, std::vector<ShareRow>& rows);

// Pairs of carriers that share vertices and turn much against each other, with 2 w_a w_b for every
// vertex; see blend_tables.h. rows gain influences of pair carriers (#joints + #twists + k). Far
// from the hinge the share fades: the web of the armpit is drawn straight, no bone pushes it out to
// the full circle.
std::vector<PairCarrier> add_pairs(const Skeleton& skeleton, const TriMesh& skin,
                                   const std::vector<TwistCarrier>& twists,
                                   std::vector<ShareRow>& rows);

}  // namespace ecorche
