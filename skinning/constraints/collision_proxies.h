// The body as a few round bodies, to tell in a glance where limbs are in one another.
//
// Balls along arms and legs, as thick as the skin is round the bone there; ellipsoids for head and
// trunk, each riding on one joint.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche {

struct LimbBall {
  int joint = -1;              // that carries it
  Vec3 centre = Vec3::Zero();  // in the joint's frame, m
  double radius = 0;           // m
  double middle = 0,
         end = 0;  // by how much of a shift of knee or elbow, and of foot or hand, it is shifted
};

struct TrunkRound {
  int joint = -1;
  Vec3 centre = Vec3::Zero();  // in the joint's frame, m
  Vec3 half = Vec3::Zero();    // half axes, along the joint's, m
};

struct BodyRounds {
  std::array<std::vector<LimbBall>, 4> limbs;  // legs, arms; left, right: as LimitTables has them
  std::vector<TrunkRound> trunk;               // pelvis to chest, neck, head
};

// From the skin at rest, #V x 3. A vertex belongs to the bone whose axis is nearest to it. Balls
// around which there is no skin (an arm that a scan lacks) are left out. Precondition
// (std::invalid_argument): the skeleton has our joints.
BodyRounds measure_rounds(const Skeleton& skeleton, const Points& skin);

}  // namespace ecorche
