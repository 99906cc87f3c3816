// Joints, poses and motions.
//
// In the rest pose every joint frame is aligned with the world: X_PJ of a joint is a pure
// translation, and a joint's local rotation is simply how far it has turned from rest. The
// anatomical axes that limits refer to are stored beside it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct Joint {
  std::string name;  // "hip_l"; data/joints.csv lists them all
  int parent = -1;   // index of the parent; parents precede children; -1 for the root
  // rest frame in the parent's rest frame (translation only)
  Transform X_PJ = Transform::Identity();
  // columns: axes of positive flexion, abduction and axial rotation, world at rest; a right-handed
  // orthonormal frame on both sides (senses: data/joints.csv)
  Mat3 axes = Mat3::Identity();
  // lower limits about the three axes, rad, from the anatomical zero
  Vec3 min = Vec3::Constant(-0.01);
  Vec3 max = Vec3::Constant(0.01);  // upper limits
  // Anatomical angles of the rest pose (the A-pose is not the anatomical zero), inside the limits.
  // A pose's angles are those of
  //   R(f, a, r) = axes^T * L * axes * R(zero),   L the joint's local rotation, R as in
  //   anatomy/joint_angles.h.
  Vec3 zero = Vec3::Zero();
};

struct Skeleton {
  std::vector<Joint> joints;
};

struct Pose {
  Vec3 root = Vec3::Zero();     // world position of the root joint
  std::vector<Quat> rotations;  // #joints, local: how far each joint has turned from rest
};

struct Motion {
  double fps = 30;
  std::vector<Pose> frames;
};

// Index of a joint by name, or -1.
int find_joint(const Skeleton& skeleton, std::string_view name);

// World positions of all joints at rest. #joints
std::vector<Vec3> rest_positions(const Skeleton& skeleton);

// The rest pose: root at its rest position, no rotation anywhere.
Pose rest_pose(const Skeleton& skeleton);

// World frame of joint j, from that of its parent in X_WJ.
Transform joint_frame(const Skeleton& skeleton, const Pose& pose,
                      const std::vector<Transform>& X_WJ, std::size_t j);

// World frames X_WJ of all joints. `out` is resized once and then reused.
// Precondition: pose.rotations has one entry a joint.
void forward_kinematics(const Skeleton& skeleton, const Pose& pose, std::vector<Transform>& out);

// Share of the knee's flexion that the patella turns on the femur (0.6-0.7 at 90 degrees, Amis
// 2006).
inline constexpr double kPatellaShare = 0.62;

// Dependent joints: the patella turns on the femur with the knee. Called by whoever makes a Pose
// from outside.
void complete_pose(const Skeleton& skeleton, Pose& pose);

}  // namespace ecorche::inline v1
