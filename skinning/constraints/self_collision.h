// Limbs that do not pass through each other, the trunk or the head.
//
// A motion of one body put on another lets knees brush through each other and hands into hips.
// Limbs are balls, trunk and head ellipsoids (skinning/constraints/collision_proxies.h); where two
// lie in one another deeper than skin gives way, knee or elbow and foot or hand are shifted apart,
// by as little as will do (after the position based dynamics of Muller et al.
// 2007, 10.1016/j.jvcir.2007.01.005). Both limbs give way alike, trunk and head stay. Over a motion
// the shifts are smoothed and topped up in turns, so that a limb begins to give way before it must.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/collision_proxies.h"
#include "skinning/constraints/joint_limits.h"

namespace ecorche {

enum class Meeting { leg_leg, arm_arm, arm_leg, arm_trunk, arm_head };
inline constexpr std::array<const char*, 5> kMeetingNames{
    "leg and leg", "arm and arm", "arm and leg", "arm and trunk", "arm and head"};

// Two round bodies that may meet, and how deep they may lie in one another.
struct RoundPair {
  int limb = 0, ball = 0;
  int other_limb = -1, other = 0;  // -1: `other` is of the trunk
  double allowed = 0;              // m
  Meeting kind = Meeting::leg_leg;
};

struct ApartTables {
  BodyRounds rounds;
  std::vector<RoundPair> pairs;
};

// What lies in one another at rest may go on doing so.
ApartTables make_apart_tables(const Skeleton& skeleton, BodyRounds rounds);

// How much deeper than allowed parts lie in one another, m, the deepest of each kind.
using MeetingDepths = std::array<double, 5>;

MeetingDepths meeting_depths(const ApartTables& tables, const std::vector<Transform>& X_WJ);

// What parts the limbs of a pose whose world frames are X_WJ.
LimbShifts part_limbs(const ApartTables& tables, const std::vector<Transform>& X_WJ);

// Each limb's shift becomes the largest within 0.05 s, then a mean over time, weighted by a bell of
// as much to either side: whole where it is largest, and begun before.
void smooth_shifts(double fps, std::vector<LimbShifts>& shifts);

}  // namespace ecorche
