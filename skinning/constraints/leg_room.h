// How far a leg folds and stretches, and what gives way where it does not.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/foot_contacts.h"

namespace ecorche::inline v1 {

// Fraction of its length to which a planted leg extends: 6 deg of knee flexion.
inline constexpr double kStraight = 0.9985;
// Beyond this part of its length a free leg stretches less and less, never to kStraight.
inline constexpr double kStretches = 0.985;

// By how much the pelvis is to rise so that the hip of a leg whose foot stands bends no further
// than it can, m; 0 where rising does not help. `ankle`, `R`: where the ankle and how the foot is
// to be, world. `pose` and X_WJ, its frames, have the leg elsewhere afterwards.
double fold_rise(const Skeleton& skeleton, const FootShape& foot, const Vec3& ankle, const Mat3& R,
                 Pose& pose, std::vector<Transform>& X_WJ);

// By how much the heel of a standing foot is to rise about its ball so that the ankle bends by
// hardly more than it can, rad. `ball`: its place; the rest as above.
double bent_rise(const Skeleton& skeleton, const FootShape& foot, const Vec3& ankle, const Mat3& R,
                 const Vec3& ball, Pose& pose, std::vector<Transform>& X_WJ);

// The rotation by which a foot that points `along`, its ball from its heel, has its heel up.
Mat3 heel_up(const Vec3& along, double angle);

// How far from its hip the ankle of a free leg comes that is asked to be `far` from it, m. `was`:
// how far it is by itself, where it may stay. `from`: up to which part of `length` it stretches as
// it likes, below kStraight.
double eased_reach(double far, double was, double length, double from);

}  // namespace ecorche::inline v1
