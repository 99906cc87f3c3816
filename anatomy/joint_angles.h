// Anatomical angles of a joint, and its limits.
#pragma once

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Flexion, abduction, axial rotation (rad) from the anatomical zero, for a local rotation that is
// counted from the rest pose. Where abduction stays below a right angle: intrinsic turns about the
// columns of Joint::axes in that order. Beyond it (shoulder) such angles are singular in the midst
// of the range and mean nothing to a clinician (Codman's paradox): there flexion and abduction are
// the parts of the one turn that swings the long axis to where it points, rotation is the turn
// about the long axis before it (swing and twist, Grassia 1998, 10.1080/10867651.1998.10487493).
// Both agree for turns about one axis.
Vec3 joint_angles(const Joint& joint, const Quat& rotation);

// The local rotation that has these angles.
Quat joint_rotation(const Joint& joint, const Vec3& angles);

// The same turn has many triples of angles: this is the one that is least outside the limits.
Vec3 joint_angles_near_limits(const Joint& joint, const Quat& rotation);

// How far the worst of the angles is outside [min, max], rad; 0 inside.
double limit_excess(const Joint& joint, const Quat& rotation);

// The last part of a range, in which a movement slows down: a tenth of it, at most 3 deg. `angle`:
// 0 flexion, 1 abduction, 2 rotation.
double limit_ease(const Joint& joint, int angle);

// Angles inside: those deeper inside than limit_ease() are kept, the others pressed together
// towards the limit, without a kink, so that a movement that runs into a limit slows down rather
// than stops. What is so far beyond one limit that it is nearly as far beyond the other (a foot
// turned backwards) goes back to the middle of the range: its sense means nothing, and it must not
// leap from limit to limit.
Quat clamped(const Joint& joint, const Quat& rotation);

// axes * R(zero); see Joint::zero. The same functions with it worked out once, for loops over
// frames.
Mat3 joint_zero(const Joint& joint);
Vec3 joint_angles(const Joint& joint, const Quat& rotation, const Mat3& zero);
Quat joint_rotation(const Joint& joint, const Vec3& angles, const Mat3& zero);
Vec3 joint_angles_near_limits(const Joint& joint, const Quat& rotation, const Mat3& zero);
double limit_excess(const Joint& joint, const Quat& rotation, const Mat3& zero);
Quat clamped(const Joint& joint, const Quat& rotation, const Mat3& zero);

}  // namespace ecorche::inline v1
