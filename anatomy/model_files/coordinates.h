// The angles that a body's joints have in other programs' models and tables: what `export` writes
// as coordinates, and motion tables as columns.
//
// A joint turns about its three anatomical axes in the order flexion, abduction, rotation, each
// carried along by those before it, whatever its range (joint_angles() tells wide joints' angles
// apart otherwise, for limits). Angles are counted from the anatomical zero.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

struct Coordinate {
  std::string name;  // "knee_l_flexion"
  int joint = 0;
  int axis = 0;  // 0 flexion, 1 abduction, 2 rotation
};

// All angles with more than 4.5 degrees to go; not the root's. Joints in order.
std::vector<Coordinate> model_coordinates(const Skeleton& skeleton);

// The root moves freely: turns about the axes forward, up and right, each carried along by those
// before it, then its way from rest along them. OpenSim's words for a pelvis: its list, its turn,
// its tilt.
inline constexpr std::array<const char*, 6> kRootCoordinates{"list", "turn", "tilt",
                                                             "tx",   "ty",   "tz"};

// List, turn and tilt of the root's rotation, rad; of all triples that mean it the one nearest to
// `near`.
Vec3 root_angles(const Quat& rotation, const Vec3& near);

// The rotation that has these.
Quat root_rotation(const Vec3& angles);

// Flexion, abduction, rotation (rad) of a local rotation that is counted from the rest pose. Of the
// two triples that mean it the one nearer to `near`, whole turns included; for a motion without
// leaps give the frame before, at first Joint::zero.
Vec3 turn_angles(const Joint& joint, const Quat& rotation, const Vec3& near);

// The local rotation that has these angles.
Quat turn_rotation(const Joint& joint, const Vec3& angles);

}  // namespace ecorche::inline v1
