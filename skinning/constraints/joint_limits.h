// A pose that joints can make, as near to a given one as can be.
//
// Trunk, neck and girdle: from the pelvis outwards, each joint keeps the world turn that it had as
// far as its limits go; what it lacks its children make up for as far as theirs go. Arms and legs:
// the angles of the limb that bring hand or foot back to where it was (hands as the thorax carries
// them, feet in the world), by damped least squares inside the limits (after Levenberg 1944 and
// Marquardt 1963), a few steps from the clamped pose; movements that run into a limit slow down
// over its last 3 degrees. What has no end to keep (toes, fingers, jaw) is clamped joint by joint;
// toes keep their world turn. A function of the pose alone.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/foot_contacts.h"

namespace ecorche {

// A limb's joints from hip to foot or from shoulder to hand, and the point that is kept in its
// place.
struct LimbChain {
  std::array<int, 4> joints{};
  Vec3 point = Vec3::Zero();  // in the last joint's frame: the ball of the foot, the wrist
  // of a leg, likewise; the tip of toes that are bent upwards as far as they go
  Vec3 heel = Vec3::Zero(), toes_up = Vec3::Zero();
  bool leg = false;
};

// Made once a skeleton.
struct LimitTables {
  std::array<LimbChain, 4> limbs;  // legs, arms; left, right
  std::array<FootShape, 2> feet;   // left, right
  // a joint: 0 local turn is clamped, 1 world turn is kept as far as can be, 2 part of a limb, 3
  // toe
  std::vector<char> kept;
  int thorax = -1;
};

// sole_height: world y of the soles at rest. Precondition: the skeleton has our joints.
LimitTables make_limit_tables(const Skeleton& skeleton, double sole_height);

struct LimitScratch {
  std::vector<Transform> before, after;  // world frames
};

// How far a limb's end may be off where that saves its angles 10 degrees: a straight leg that is a
// little short of its place would leap straight otherwise.
struct LimbHold {
  double place = 4e-3;   // m
  double turn = 0.0175;  // rad
  // y = 0 is the ground: feet that stand stay to a tenth of a millimetre, and soles do not sink
  // into it
  bool ground = false;
};

// How far a limb's ends are to be put from where the given pose has them, in the world, m: knee or
// elbow, and foot or hand.
struct LimbShift {
  Vec3 middle = Vec3::Zero(), end = Vec3::Zero();
};
using LimbShifts = std::array<LimbShift, 4>;  // as LimitTables::limbs

// Which points of a foot stand where the given pose has them.
struct FootStand {
  bool heel = false, ball = false;
};

// Brings `pose` inside the limits. Its root stays. scratch.before and scratch.after are the world
// frames of the two poses. `stands`: left and right foot; they count where hold.ground is set.
void keep_limits(const Skeleton& skeleton, const LimitTables& tables, const LimbHold& hold,
                 const std::array<FootStand, 2>& stands, const LimbShifts& shifts, Pose& pose,
                 LimitScratch& scratch);

}  // namespace ecorche
