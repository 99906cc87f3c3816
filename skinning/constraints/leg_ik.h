// Two-bone inverse kinematics of a leg.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/foot_contacts.h"

namespace ecorche {

// Turns hip and knee so that the ankle comes to `ankle` (world) and ankle and subtalar joint so
// that the foot has the world rotation `foot_rotation`. The knee bends about its own axis,
// forwards, and keeps its plane but for what the ankle's move asks. X_WJ are the frames of `pose`;
// those of the leg are brought up to date. Returns how much the leg is too short, m.
double reach_with_leg(const Skeleton& skeleton, const FootShape& foot, const Vec3& ankle,
                      const Mat3& foot_rotation, Pose& pose, std::vector<Transform>& X_WJ);

// How far the ankle can come from the hip, m: knees that are not quite straight seen from before do
// not add up.
double straight_leg(const Skeleton& skeleton, const FootShape& foot,
                    const std::vector<Transform>& X_WJ);

// The ankle's place and the foot's direction stay; what of the foot's turning the ankle's two
// joints have no axis for, pointing the toes out or in, becomes a turn of the shin at the knee, as
// far as the knee's limits go. The subtalar joint moves by a millimetre or so with it: to be called
// before feet are planted.
void turn_shin_with_foot(const Skeleton& skeleton, const FootShape& foot, Pose& pose);

}  // namespace ecorche
