// Anatomical angles of a joint, and its limits.
#pragma once

#include "anatomy/skeleton.h"

namespace ecorche {

// Flexion, abduction, axial rotation (rad) from the anatomical zero, for a local rotation that is counted from the rest pose:
// intrinsic turns about the columns of Joint::axes in that order, after those that Joint::zero says the rest pose already has.
Vec3 joint_angles(const Joint& joint, const Quat& rotation);

// The local rotation that has these angles.
Quat joint_rotation(const Joint& joint, const Vec3& angles);

// How far the worst of the angles is outside [min, max], rad; 0 inside.
double limit_excess(const Joint& joint, const Quat& rotation);

// The nearest angles inside.
Quat clamped(const Joint& joint, const Quat& rotation);

}  // namespace ecorche
