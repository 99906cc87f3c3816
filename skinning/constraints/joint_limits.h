// Joint limits: the pose within limits that is nearest to a given one.
//
// Trunk, neck and girdle: from the pelvis outwards, each joint keeps its world rotation as far as
// its limits allow; its children make up for the rest as far as theirs allow. Arms and legs: the
// angles of the limb that bring hand or foot back to its position (hands as the thorax carries
// them, feet in the world), by damped least squares inside the limits (after Levenberg 1944 and
// Marquardt 1963), a few steps from the clamped pose; movements that run into a limit slow down
// over its last 3 degrees. Toes, fingers and jaw have no end to keep and are clamped joint by
// joint; toes keep their world rotation. The result depends on the one pose alone.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/foot_contacts.h"

namespace ecorche::inline v1 {

// A limb's joints from hip to foot or from shoulder to hand, and the point whose position is kept.
struct LimbChain {
  std::array<int, 4> joints{};
  Vec3 point = Vec3::Zero();  // in the last joint's frame: the ball of the foot, the wrist
  // of a leg, likewise; `toes_up` is the tip of the toes at full extension
  Vec3 heel = Vec3::Zero(), toes_up = Vec3::Zero();
  bool leg = false;
  std::vector<int> above;  // the limb's joints, a leg's toes, the thorax of an arm, and all above
};

// Made once a skeleton.
struct LimitTables {
  std::array<LimbChain, 4> limbs;  // legs, arms; left, right
  std::array<FootShape, 2> feet;   // left, right
  // by joint: 0 local rotation is clamped, 1 world rotation is kept as far as possible, 2 part of a
  // limb, 3 toe
  std::vector<char> kept;
  std::vector<Mat3> zeros;  // by joint: joint_zero()
  int thorax = -1;
  std::vector<int> needed;  // joints whose frames matter: trunk, head, limbs, toes' first ones
};

// sole_height: world y of the soles at rest. Precondition: the skeleton has our joints.
LimitTables make_limit_tables(const Skeleton& skeleton, double sole_height);

struct LimitWorkspace {
  std::vector<Transform> before, after;  // world frames
  // By joint: the last rotation that was clamped by itself, and what became of it.
  struct Clamped {
    Quat given{0, 0, 0, 0}, inside = Quat::Identity();
  };
  std::vector<Clamped> clamped;
};

// Error of a limb's end that counts as much as 10 degrees of its joint angles. Smaller values make
// a leg that is slightly too short snap straight; larger ones let hands and feet drift.
struct LimbTolerance {
  double position = 4e-3;  // m
  double rotation = 0.07;  // rad
  // y = 0 is the ground: standing feet keep their position to 0.1 mm, and soles do not sink into it
  bool on_ground = false;
  bool operator==(const LimbTolerance&) const = default;
};

// Wanted displacement of knee or elbow (`middle`) and of foot or hand (`end`) from the given pose,
// world, m.
struct LimbShift {
  Vec3 middle = Vec3::Zero(), end = Vec3::Zero();
  bool operator==(const LimbShift&) const = default;
};
using LimbShifts = std::array<LimbShift, 4>;  // as LimitTables::limbs

// Points of a foot that keep their position in the given pose.
struct FootStand {
  bool heel = false, ball = false;
  bool operator==(const FootStand&) const = default;
};

// Brings `pose` inside the limits. Its root stays. `stands`: left and right foot; used if
// tolerance.on_ground is set. Afterwards workspace.before and workspace.after are the world frames
// of the given and the new pose, of LimitTables::needed.
void enforce_limits(const Skeleton& skeleton, const LimitTables& tables,
                    const LimbTolerance& tolerance, const std::array<FootStand, 2>& stands,
                    const LimbShifts& shifts, Pose& pose, LimitWorkspace& workspace);

// The same for `which` limbs alone, as LimitTables::limbs. The rest of `pose` is inside its limits
// already and stays: it is what enforce_limits() has made of `given`, whose root and whose shifts
// of these limbs may have changed since, or `given` itself.
void renew_limbs(const Skeleton& skeleton, const LimitTables& tables,
                 const LimbTolerance& tolerance, const std::array<FootStand, 2>& stands,
                 const LimbShifts& shifts, const std::array<bool, 4>& which, const Pose& given,
                 Pose& pose, LimitWorkspace& workspace);

// Brings a foot to the world frame `foot` by its leg's joints alone, within limits, from the angles
// that `pose` has, whose knee it keeps near; toes that would be in the ground extend. A point that
// stands comes to 0.1 mm where the leg reaches. Overwrites `workspace`.
void stand_with_leg(const Skeleton& skeleton, const LimitTables& tables, Side side,
                    const LimbTolerance& tolerance, const FootStand& stand, const Transform& foot,
                    Pose& pose, LimitWorkspace& workspace);

}  // namespace ecorche::inline v1
