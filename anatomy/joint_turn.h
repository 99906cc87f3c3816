// The rotation of a joint's three angles, and how it changes with each of them.
#pragma once

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Whether the joint's first two angles are the parts of one swing; see joint_angles().
bool swings(const Joint& joint);

// Rotation by the angles, in the joint's axes, from the anatomical zero.
Mat3 joint_turn(const Joint& joint, const Vec3& angles);

// The same, and the axes about which it goes on as an angle grows, one a column: the rotation's
// change is (rate x) * rotation. For a swing these are the columns of the left Jacobian of the
// exponential map (Grassia 1998, 10.1080/10867651.1998.10487493).
struct TurnWithRates {
  Mat3 turn, rates;
};
TurnWithRates joint_turn_with_rates(const Joint& joint, const Vec3& angles);

}  // namespace ecorche::inline v1
