// Our joint tree at approximate places of the base mesh, for tests that need no package: 1.7 m,
// A-pose, ground at y = -0.82.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche {

struct PlainJoint {
  const char* name;
  const char* parent;
  double x, y, z;  // rest position, left side
  const char*
      hinge;  // "x", "-x", "y", "bend": flexion about the normal of the bend at the joint; "" none
  double flexion[2], abduction[2], rotation[2];  // limits, deg
};

inline const std::vector<PlainJoint>& plain_joints() {
  static const std::vector<PlainJoint> joints = {
      {"pelvis", "", 0, 0.042, 0.030, "x", {-180, 180}, {-180, 180}, {-180, 180}},
      {"l5", "pelvis", 0, 0.122, 0.000, "x", {-5, 9}, {-3, 3}, {-1, 1}},
      {"l4", "l5", 0, 0.158, 0.010, "x", {-2, 13}, {-6, 6}, {-2, 2}},
      {"l3", "l4", 0, 0.194, 0.014, "x", {-1, 12}, {-8, 8}, {-2, 2}},
      {"l2", "l3", 0, 0.229, 0.014, "x", {-3, 10}, {-6, 6}, {-2, 2}},
      {"l1", "l2", 0, 0.263, 0.010, "x", {-5, 8}, {-6, 6}, {-2, 2}},
      {"t12", "l1", 0, 0.296, 0.002, "x", {-6, 6}, {-8, 8}, {-2, 2}},
      {"t11", "t12", 0, 0.325, -0.006, "x", {-6, 6}, {-9, 9}, {-2, 2}},
      {"thorax", "t11", 0, 0.352, -0.013, "x", {-12, 20}, {-20, 20}, {-30, 30}},
      {"c7", "thorax", 0, 0.560, -0.010, "x", {-5, 5}, {-4, 4}, {-2, 2}},
      {"c6", "c7", 0, 0.577, -0.003, "x", {-9, 9}, {-7, 7}, {-6, 6}},
      {"c5", "c6", 0, 0.593, 0.002, "x", {-10, 10}, {-8, 8}, {-7, 7}},
      {"c4", "c5", 0, 0.609, 0.005, "x", {-10, 10}, {-11, 11}, {-7, 7}},
      {"c3", "c4", 0, 0.625, 0.006, "x", {-8, 8}, {-11, 11}, {-7, 7}},
      {"c2", "c3", 0, 0.641, 0.006, "x", {-5, 5}, {-10, 10}, {-3, 3}},
      {"c1", "c2", 0, 0.668, 0.005, "x", {-10, 10}, {-5, 5}, {-40, 40}},
      {"head", "c1", 0, 0.682, 0.005, "x", {-17, 10}, {-5, 5}, {-4, 4}},
      {"jaw", "head", 0, 0.690, 0.070, "x", {0, 35}, {-4, 4}, {-4, 4}},
      {"clavicle_l", "thorax", 0.022, 0.520, 0.085, "y", {-25, 25}, {-10, 45}, {-5, 40}},
      {"scapula_l", "clavicle_l", 0.165, 0.560, 0.035, "x", {-15, 30}, {-15, 35}, {-20, 20}},
      {"shoulder_l", "scapula_l", 0.168, 0.525, 0.015, "x", {-180, 180}, {-180, 180}, {-180, 180}},
      {"elbow_l", "shoulder_l", 0.313, 0.349, 0.013, "bend", {-5, 150}, {-4, 4}, {-4, 4}},
      {"forearm_l", "elbow_l", 0.330, 0.340, 0.022, "x", {-180, 180}, {-180, 180}, {-180, 180}},
      {"wrist_l", "forearm_l", 0.431, 0.245, 0.176, "x", {-180, 180}, {-180, 180}, {-180, 180}},
      {"cmc1_l", "wrist_l", 0.427, 0.240, 0.196, "x", {-90, 90}, {-90, 90}, {-90, 90}},
      {"mcp1_l", "cmc1_l", 0.410, 0.226, 0.237, "x", {-90, 90}, {-90, 90}, {-90, 90}},
      {"ip1_l", "mcp1_l", 0.398, 0.211, 0.268, "bend", {-90, 90}, {-90, 90}, {-90, 90}},
      {"mcp2_l", "wrist_l", 0.447, 0.207, 0.251, "bend", {-90, 90}, {-90, 90}, {-90, 90}},
      {"pip2_l", "mcp2_l", 0.453, 0.190, 0.285, "bend", {-90, 105}, {-90, 90}, {-90, 90}},
      {"dip2_l", "pip2_l", 0.453, 0.175, 0.302, "bend", {-90, 90}, {-90, 90}, {-90, 90}},
      {"mcp3_l", "wrist_l", 0.457, 0.196, 0.241, "bend", {-90, 90}, {-90, 90}, {-90, 90}},
      {"pip3_l", "mcp3_l", 0.471, 0.167, 0.269, "bend", {-90, 105}, {-90, 90}, {-90, 90}},
      {"dip3_l", "pip3_l", 0.475, 0.149, 0.286, "bend", {-90, 90}, {-90, 90}, {-90, 90}},
      {"mcp4_l", "wrist_l", 0.463, 0.192, 0.223, "bend", {-90, 90}, {-90, 90}, {-90, 90}},
      {"pip4_l", "mcp4_l", 0.481, 0.162, 0.246, "bend", {-90, 105}, {-90, 90}, {-90, 90}},
      {"dip4_l", "pip4_l", 0.486, 0.143, 0.259, "bend", {-90, 90}, {-90, 90}, {-90, 90}},
      {"mcp5_l", "wrist_l", 0.471, 0.183, 0.206, "bend", {-90, 90}, {-90, 90}, {-90, 90}},
      {"pip5_l", "mcp5_l", 0.481, 0.158, 0.222, "bend", {-90, 105}, {-90, 90}, {-90, 90}},
      {"dip5_l", "pip5_l", 0.483, 0.146, 0.228, "bend", {-90, 90}, {-90, 90}, {-90, 90}},
      {"hip_l", "pelvis", 0.090, 0.041, 0.044, "-x", {-30, 125}, {-180, 180}, {-180, 180}},
      {"patella_l", "hip_l", 0.158, -0.365, 0.055, "x", {-5, 95}, {-5, 5}, {-5, 5}},
      {"knee_l", "hip_l", 0.158, -0.370, 0.032, "x", {-5, 150}, {-180, 180}, {-180, 180}},
      {"ankle_l", "knee_l", 0.220, -0.745, -0.001, "-x", {-50, 25}, {-180, 180}, {-180, 180}},
      {"subtalar_l", "ankle_l", 0.215, -0.770, -0.005, "-x", {-180, 180}, {-180, 180}, {-180, 180}},
      {"mtp1_l", "subtalar_l", 0.190, -0.795, 0.118, "x", {-70, 45}, {-10, 10}, {-5, 5}},
      {"toe_ip1_l", "mtp1_l", 0.191, -0.800, 0.162, "x", {0, 70}, {-5, 5}, {-5, 5}},
      {"mtp2_l", "subtalar_l", 0.214, -0.796, 0.116, "x", {-50, 40}, {-10, 10}, {-5, 5}},
      {"toe_pip2_l", "mtp2_l", 0.215, -0.800, 0.160, "x", {-5, 35}, {-5, 5}, {-5, 5}},
      {"toe_dip2_l", "toe_pip2_l", 0.215, -0.801, 0.174, "x", {-30, 60}, {-5, 5}, {-5, 5}},
      {"mtp3_l", "subtalar_l", 0.230, -0.797, 0.108, "x", {-50, 40}, {-10, 10}, {-5, 5}},
      {"toe_pip3_l", "mtp3_l", 0.231, -0.800, 0.156, "x", {-5, 35}, {-5, 5}, {-5, 5}},
      {"toe_dip3_l", "toe_pip3_l", 0.231, -0.801, 0.168, "x", {-30, 60}, {-5, 5}, {-5, 5}},
      {"mtp4_l", "subtalar_l", 0.244, -0.798, 0.098, "x", {-50, 40}, {-10, 10}, {-5, 5}},
      {"toe_pip4_l", "mtp4_l", 0.246, -0.800, 0.143, "x", {-5, 35}, {-5, 5}, {-5, 5}},
      {"toe_dip4_l", "toe_pip4_l", 0.246, -0.801, 0.155, "x", {-30, 60}, {-5, 5}, {-5, 5}},
      {"mtp5_l", "subtalar_l", 0.256, -0.798, 0.085, "x", {-50, 40}, {-10, 10}, {-5, 5}},
      {"toe_pip5_l", "mtp5_l", 0.261, -0.800, 0.135, "x", {-5, 35}, {-5, 5}, {-5, 5}},
      {"toe_dip5_l", "toe_pip5_l", 0.260, -0.801, 0.143, "x", {-30, 60}, {-5, 5}, {-5, 5}},
  };
  return joints;
}

// Axes: flexion as said, abduction and rotation square to it; limits as listed, zero angles: the
// bend of elbow and fingers.
inline Skeleton plain_skeleton(double scale = 1) {
  Skeleton skeleton;
  std::vector<Vec3> at;
  auto add = [&](const PlainJoint& plain, const std::string& suffix, double mirror) {
    Joint joint;
    joint.name = plain.name;
    std::string parent = plain.parent;
    if (!suffix.empty()) {
      joint.name.replace(joint.name.size() - 2, 2, suffix);
      if (parent.ends_with("_l")) parent.replace(parent.size() - 2, 2, suffix);
    }
    const Vec3 position = scale * Vec3(mirror * plain.x, plain.y, plain.z);
    joint.parent = parent.empty() ? -1 : find_joint(skeleton, parent);
    joint.X_PJ.translation() = joint.parent < 0 ? position : Vec3(position - at[joint.parent]);
    joint.min = kDegree * Vec3(plain.flexion[0], plain.abduction[0], plain.rotation[0]);
    joint.max = kDegree * Vec3(plain.flexion[1], plain.abduction[1], plain.rotation[1]);
    const std::string hinge = plain.hinge;
    // Columns: flexion, abduction (to the own side; trunk: to the left), rotation.
    const bool trunk = suffix.empty();
    if (hinge == "x" && trunk) joint.axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    if (hinge == "x" && !trunk) joint.axes << 1, 0, 0, 0, 0, -mirror, 0, mirror, 0;
    if (hinge == "-x") joint.axes << -1, 0, 0, 0, 0, mirror, 0, mirror, 0;
    if (hinge == "y") joint.axes << 0, 0, -1, -mirror, 0, 0, 0, mirror, 0;
    skeleton.joints.push_back(joint);
    at.push_back(position);
  };
  for (const PlainJoint& plain : plain_joints()) {
    const bool paired = std::string(plain.name).ends_with("_l");
    add(plain, paired ? "_l" : "", 1);
    if (paired) add(plain, "_r", -1);
  }
  // "bend": square to the bones that meet at the joint (or at the one before it, for the last of a
  // finger).
  for (const PlainJoint& plain : plain_joints())
    for (const std::string side : {"_l", "_r"}) {
      if (std::string(plain.hinge) != "bend") continue;
      std::string name = plain.name;
      name.replace(name.size() - 2, 2, side);
      const int j = find_joint(skeleton, name);
      int next = -1;
      for (size_t k = 0; k < skeleton.joints.size(); ++k)
        if (skeleton.joints[k].parent == j && next < 0) next = int(k);
      if (name.starts_with("elbow")) next = find_joint(skeleton, "wrist" + side);
      const int before = skeleton.joints[j].parent;
      const Vec3 lower = next >= 0 ? Vec3(at[next] - at[j]) : Vec3(at[j] - at[before]);
      const Vec3 upper = next >= 0 ? Vec3(at[j] - at[before])
                                   : Vec3(at[before] - at[skeleton.joints[before].parent]);
      Mat3& axes = skeleton.joints[j].axes;
      const Vec3 before_joint = name.starts_with("elbow")
                                    ? Vec3(at[j] - at[find_joint(skeleton, "shoulder" + side)])
                                    : upper;
      axes.col(0) = before_joint.normalized().cross(lower.normalized());
      skeleton.joints[j].zero[0] = std::asin(std::min(1.0, axes.col(0).norm()));
      axes.col(0).normalize();
      axes.col(2) = lower.normalized();
      axes.col(1) = axes.col(2).cross(axes.col(0)).normalized();
    }
  return skeleton;
}

}  // namespace ecorche
