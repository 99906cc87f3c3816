// A segment of the body as a rigid body, for dynamics and for exported models.
#pragma once

#include <string>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct BodySegment {
  std::string name;             // "thigh_l"
  int joint = 0;                // whose frame carries it
  double mass = 0;              // kg
  Vec3 center = Vec3::Zero();   // of mass, in the joint's frame, m
  Mat3 inertia = Mat3::Zero();  // about the centre of mass, axes of the joint's frame, kg m^2
};

}  // namespace ecorche::inline v1
