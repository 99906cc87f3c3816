// Forces of a motion as tables a row a frame.
#pragma once

#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/dynamics/static_optimization.h"
#include "skinning/motion_files/motion_table.h"

namespace ecorche {

// A joint's moment about one of its anatomical angles, as motion tables name them.
struct MomentCurve {
  std::string name;            // "knee_l_flexion"
  std::vector<double> moment;  // #frames, N m, positive the way the angle grows
};

// Of all angles that carry a segment.
std::vector<MomentCurve> moment_curves(const Skeleton& skeleton,
                                       const std::vector<BodySegment>& segments,
                                       const MotionDynamics& dynamics);

// Ground forces, centres of pressure, free moments, moments and power of joints, the centre of mass
// and the residual, in OpenSim's axes: x forward, y up, z right. With `efforts` also the part of
// moments that no muscle gives.
MotionTable dynamics_table(const Skeleton& skeleton, const std::vector<BodySegment>& segments,
                           const MotionDynamics& dynamics, const MuscleEfforts* efforts = nullptr);

// A row a frame, a column a muscle that is ever active.
MotionTable activation_table(const Anatomy& anatomy, const MotionDynamics& dynamics,
                             const MuscleEfforts& efforts);

}  // namespace ecorche
