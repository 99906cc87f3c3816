// Collision proxies of a body: spheres along arms and legs, as thick as the skin around the bone,
// and ellipsoids for head and trunk. Each moves with one joint.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

struct LimbSphere {
  int joint = -1;              // that it moves with
  Vec3 centre = Vec3::Zero();  // in the joint's frame, m
  double radius = 0;           // m
  // Fractions of a shift of knee or elbow, and of foot or hand, that displace the sphere, 0 .. 1.
  double middle = 0, end = 0;
  double gives = 0;  // m; by which its fat gives way
};

struct TrunkEllipsoid {
  int joint = -1;              // that it moves with
  Vec3 centre = Vec3::Zero();  // in the joint's frame, m
  Vec3 half = Vec3::Zero();    // half axes, along the joint's, m
  double gives = 0;            // m; by which its fat gives way
};

struct CollisionProxies {
  std::array<std::vector<LimbSphere>, 4> limbs;  // legs, arms; left, right: as LimitTables has them
  std::vector<TrunkEllipsoid> trunk;             // pelvis to chest, neck, head
};

// Fits the proxies to the skin at rest, #V x 3. A vertex belongs to the bone whose axis is nearest.
// Spheres without skin around them (an arm that a scan lacks) are left out. Precondition
// (std::invalid_argument): the skeleton has our joints.
CollisionProxies measure_proxies(const Skeleton& skeleton, const Points& skin);

}  // namespace ecorche::inline v1
