// Shoulder rhythm: rotation of clavicle and scapula with the arm.
#pragma once

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct Girdle {
  Quat clavicle = Quat::Identity();  // rotations from rest in the thorax frame
  Quat scapula = Quat::Identity();
};

// The increments of de Groot & Brand (2001, 10.1016/S0268-0033(01)00065-3) from the rest pose's arm
// to this one. `arm_rest`, `arm`: direction of the upper arm in the thorax's frame (+X left, +Y up,
// +Z forward). Identity at rest. Beyond 150 deg of elevation nothing more is added.
Girdle girdle_rhythm(Side side, const Vec3& arm_rest, const Vec3& arm);

}  // namespace ecorche::inline v1
