// Two-bone inverse kinematics of a leg.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/foot_contacts.h"

namespace ecorche::inline v1 {

// Rotates hip and knee so that the ankle comes to `ankle` (world), and ankle and subtalar joint so
// that the foot has the world rotation `foot_rotation`. The knee bends about its own axis,
// forwards, and keeps its plane as far as the ankle's position allows. X_WJ are the frames of
// `pose`; those of the leg are brought up to date. Returns the distance by which the leg is too
// short, m.
double reach_with_leg(const Skeleton& skeleton, const FootShape& foot, const Vec3& ankle,
                      const Mat3& foot_rotation, Pose& pose, std::vector<Transform>& X_WJ);

// Largest distance of the ankle from the hip, m. It is less than the sum of thigh and shank for
// knees with a valgus angle.
double straight_leg(const Skeleton& skeleton, const FootShape& foot,
                    const std::vector<Transform>& X_WJ);

// How far a hip is to sink so that a leg of length `reach` comes down to `ankle`, m: below 0 where
// it may rise by so much; 0 where the ankle is too far aside for any height.
double hip_drop(const Vec3& hip, const Vec3& ankle, double reach);

// Moves the component of the foot's rotation that ankle and subtalar joint have no axis for,
// pointing the toes out or in, to an axial rotation of the shin at the knee, within the knee's
// limits. The ankle's position and the foot's direction are kept. Displaces the subtalar joint by a
// millimetre or so, so call it before foot planting.
void turn_shin_with_foot(const Skeleton& skeleton, const FootShape& foot, Pose& pose);

}  // namespace ecorche::inline v1
