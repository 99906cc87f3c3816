// The plain skeleton with a man's legs.
#pragma once

#include <string>

#include "tests/skinning/plain_skeleton.h"

namespace ecorche {

// The plain skeleton's knees and feet are free; here they are a man's.
inline Skeleton skeleton_with_legs() {
  Skeleton skeleton = plain_skeleton();
  for (const double side : {1.0, -1.0}) {
    const std::string s = side > 0 ? "_l" : "_r";
    const auto limit = [&](const std::string& name, const Vec3& low, const Vec3& high) -> Joint& {
      Joint& joint = skeleton.joints[find_joint(skeleton, name + s)];
      joint.min = low * kDegree, joint.max = high * kDegree;
      return joint;
    };
    limit("knee", {-5, -3, -30}, {150, 3, 10});
    limit("ankle", {-50, -2, -2}, {30, 2, 2});
    Mat3& axes = limit("subtalar", {-2, -2, -15}, {2, 2, 35}).axes;
    axes.col(2) = Vec3(0.16, -0.61 * side, -0.78 * side).normalized();
    axes.col(0) = Vec3(-1, 0, 0) - Vec3(-1, 0, 0).dot(axes.col(2)) * axes.col(2);
    axes.col(0).normalize();
    axes.col(1) = axes.col(2).cross(axes.col(0));
  }
  return skeleton;
}

}  // namespace ecorche
