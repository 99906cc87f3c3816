// Scan -> the base mesh on its surface, the pose it stood in, and the body brought to rest.
//
// Coarse to fine, as in Yoshiyasu et al. (the statistics paper), made robust: hypotheses of
// orientation and pose, an articulated fit of shape and pose in our shape space, and a refinement
// as similar as possible to it. What the scan does not show comes from the shape space.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "morph/registration/scan.h"

namespace ecorche::inline v1 {

// The pose of a registered body: local rotations of the body package's rig that registration
// articulates, from the base mesh's rest pose.
struct RegisteredPose {
  std::vector<std::string> joints;
  std::vector<int> parents;  // parents precede children; -1 for the root
  std::vector<Vec3> rest;    // joint centres at rest, m
  std::vector<Vec3> posed;   // in the scan, m
  std::vector<Quat> rotations;
};

// Distances between the scan and the registered body, on what was seen, m.
struct DistanceFigures {
  double mean = 0, median = 0, p95 = 0, max = 0;
};

struct RegistrationReport {
  DistanceFigures scan_to_body, body_to_scan;
  double unseen = 0;                // share of the body's area that the scan says nothing about
  double doubt = 0;                 // 0 sure .. 1: how near the best other hypothesis came
  double shape_distance = 0;        // of the coefficients, in standard deviations a coefficient
  double turn_deviation = 0;        // of joints from usual turns, in deviations: root mean square
  std::vector<std::string> doubts;  // why the result is written as doubtful; empty: it is not
  double pose_ms = 0, shape_ms = 0, surface_ms = 0;
};

struct Registration {
  Points posed;  // #skin x 3, the base mesh on the scan's surface, world, soles near y = 0
  Body body;     // the same person in the base mesh's rest pose, on the floor
  std::vector<Mat3> turn;  // #skin: posed = turn rest + something, near each vertex
  RegisteredPose pose;
  // scan coordinates -> world of `posed`: x = scale * axes * source + shift
  double scale = 1;  // metres a source unit
  Mat3 axes = Mat3::Identity();
  Vec3 shift = Vec3::Zero();
  std::vector<char> seen;  // #skin
  RegistrationReport report;
};

}  // namespace ecorche::inline v1
