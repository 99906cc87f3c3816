// Self-collision of limbs with each other, the trunk and the head.
//
// A motion of one body on another lets knees pass through each other and hands into hips. Limbs are
// represented by spheres, trunk and head by ellipsoids (collision_proxies.h). Where two penetrate
// deeper than soft tissue yields and fat gives way, knee or elbow and foot or hand are shifted by
// the least amount that separates them (after the position based dynamics of Muller et al.
// 2007, 10.1016/j.jvcir.2007.01.005). Two limbs share the correction equally, trunk and head stay.
// Over a motion the shifts are smoothed and increased in alternation, so that a limb begins to move
// before the collision.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/collision_proxies.h"
#include "skinning/constraints/joint_limits.h"

namespace ecorche::inline v1 {

enum class CollisionKind { leg_leg, arm_arm, arm_leg, arm_trunk, arm_head };
inline constexpr std::array<const char*, 5> kCollisionNames{
    "leg and leg", "arm and arm", "arm and leg", "arm and trunk", "arm and head"};

// Two proxies that may collide, and the tolerated depth.
struct ProxyPair {
  int limb = 0, sphere = 0;
  int other_limb = -1, other = 0;  // other_limb -1: `other` is an ellipsoid of the trunk
  double allowed = 0;              // m
  CollisionKind kind = CollisionKind::leg_leg;
};

struct SelfCollisionTables {
  CollisionProxies proxies;
  std::vector<ProxyPair> pairs;
};

// Penetration that exists at rest is tolerated.
SelfCollisionTables make_collision_tables(const Skeleton& skeleton, CollisionProxies proxies);

// Largest penetration beyond the tolerated depth, m, by CollisionKind.
using PenetrationDepths = std::array<double, 5>;

PenetrationDepths penetration_depths(const SelfCollisionTables& tables,
                                     const std::vector<Transform>& X_WJ);

// Two proxies that penetrate beyond what is tolerated.
struct ProxyContact {
  int joint = 0, other_joint = 0;  // that carry them
  Vec3 point = Vec3::Zero();       // in the middle of the overlap, world
  Vec3 out = Vec3::Zero();         // unit, in which the first leaves the second
  double depth = 0;                // beyond the tolerated, m
};

// All of them in a pose, in the order of the pairs. `out` is reused.
void find_proxy_contacts(const SelfCollisionTables& tables, const std::vector<Transform>& X_WJ,
                         std::vector<ProxyContact>& out);

// Shifts that separate the limbs of a pose whose world frames are X_WJ.
LimbShifts separate_limbs(const SelfCollisionTables& tables, const std::vector<Transform>& X_WJ);

// Temporal smoothing of each limb's shift (temporal_smoothing.h) over 0.05 s to either side: the
// largest shift is reached in its own frame, and begins before it.
void smooth_shifts(double fps, std::vector<LimbShifts>& shifts);

}  // namespace ecorche::inline v1
