// Generated strips and limbs for the tests of muscle lines, posing and surfaces.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/muscles/action_line.h"

namespace ecorche::testing {

inline PathPoint on(int joint, const Vec3& p) {
  PathPoint point;
  point.rest = p;
  point.joints[0] = joint;
  return point;
}

// Sections of a spindle: tendon of radius `tendon` outside the belly, widest in its middle.
inline std::vector<Station> spindle(int count, double radius, double tendon, double begin,
                                    double end, const Vec3& width) {
  std::vector<Station> stations;
  for (int k = 0; k < count; ++k) {
    Station station;
    station.s = double(k) / (count - 1);
    const double u = (station.s - begin) / (end - begin);
    const double bulge = u > 0 && u < 1 ? std::sin(std::numbers::pi * u) : 0;
    station.radii =
        Vec2(tendon + (radius - tendon) * bulge, 0.7 * (tendon + (radius - tendon) * bulge));
    station.width = width;
    stations.push_back(station);
  }
  return stations;
}

// Straight from a to b on joint 0, all sections alike, their width along x.
inline Strip straight_strap(const Vec3& a, const Vec3& b, int count, const Vec2& radii) {
  std::vector<Station> stations;
  for (int k = 0; k < count; ++k) {
    Station station;
    station.s = k / double(count - 1);
    station.radii = radii;
    station.width = Vec3::UnitX();
    stations.push_back(station);
  }
  return make_strip({on(0, a), on(0, 0.5 * (a + b)), on(0, b)}, stations);
}

// A bent, twisting path with uneven pieces.
inline std::vector<PathPoint> bent_path() {
  return {on(0, {0.02, 1.30, 0.01}), on(0, {0.03, 1.22, 0.03}), on(1, {0.05, 1.02, 0.035}),
          on(1, {0.045, 0.99, 0.03}), on(2, {0.03, 0.90, -0.01})};
}

// An arm that hangs: trunk > shoulder > elbow > forearm (axial) > wrist, straight down the left
// side, bending forward (about -x). `mirror` = -1 gives the right arm, `scale` a larger body.
inline Skeleton arm_skeleton(double mirror = 1, double scale = 1) {
  const std::vector<Vec3> at{
      {0, 1.30, 0}, {0.18, 1.45, 0}, {0.18, 1.15, 0}, {0.18, 1.13, 0}, {0.18, 0.90, 0}};
  const char* names[] = {"trunk", "shoulder", "elbow", "forearm", "wrist"};
  Skeleton skeleton;
  for (int j = 0; j < 5; ++j) {
    Joint joint;
    joint.name = names[j];
    joint.parent = j - 1;
    Vec3 step = j == 0 ? at[0] : Vec3(at[j] - at[j - 1]);
    step.x() *= mirror;
    joint.X_PJ.translation() = scale * step;
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

struct ArmPart {
  const char* name;
  std::vector<PathPoint> path;
  double radius, begin, end;
  Vec3 width;
  std::vector<Wrap> wraps;
};

inline Wrap wrap_on(int joint, Wrap::Kind kind, const Vec3& center, const Vec3& radii,
                    const Vec3& axis = Vec3::UnitX()) {
  Wrap wrap;
  wrap.joint = joint;
  wrap.kind = kind;
  wrap.X_WO.linear() = Quat::FromTwoVectors(Vec3::UnitZ(), axis).toRotationMatrix();
  wrap.X_WO.translation() = center;
  wrap.radii = radii;
  return wrap;
}

inline std::vector<ArmPart> arm_parts() {
  const Wrap elbow = wrap_on(1, Wrap::Kind::cylinder, {0.18, 1.15, 0}, {0.019, 0.019, 0.04});
  const Wrap head = wrap_on(1, Wrap::Kind::sphere, {0.18, 1.45, 0}, {0.024, 0.024, 0.024});
  const Wrap chest = wrap_on(0, Wrap::Kind::ellipsoid, {0, 1.35, 0}, {0.13, 0.22, 0.10});
  return {
      {"biceps",
       {on(0, {0.15, 1.48, 0.005}), on(1, {0.18, 1.44, 0.035}), on(1, {0.18, 1.25, 0.03}),
        on(1, {0.18, 1.18, 0.027}), on(3, {0.18, 1.105, 0.012})},
       0.022,
       0.25,
       0.82,
       {1, 0, 0},
       {head, elbow}},
      {"brachialis",
       {on(1, {0.18, 1.30, 0.012}), on(1, {0.18, 1.20, 0.025}), on(2, {0.18, 1.115, 0.012})},
       0.018,
       0.05,
       0.85,
       {1, 0, 0},
       {elbow}},
      {"triceps",
       {on(0, {0.17, 1.43, -0.02}), on(1, {0.18, 1.35, -0.03}), on(1, {0.18, 1.20, -0.027}),
        on(2, {0.18, 1.165, -0.0245}), on(2, {0.18, 1.14, -0.022})},
       0.024,
       0.1,
       0.75,
       {1, 0, 0},
       {elbow}},
      {"deltoid",
       {on(0, {0.20, 1.485, 0}), on(1, {0.222, 1.44, 0}), on(1, {0.215, 1.38, 0}),
        on(1, {0.192, 1.31, 0})},
       0.025,
       0,
       0.9,
       {0, 0, 1},
       {head}},
      {"pronator",
       {on(1, {0.155, 1.16, 0.008}), on(2, {0.17, 1.10, 0.015}), on(3, {0.19, 1.04, 0.008})},
       0.010,
       0.1,
       0.9,
       {1, 0, 0},
       {}},
      {"pectoral",
       {on(0, {0.02, 1.40, 0.115}), on(0, {0.08, 1.42, 0.115}), on(0, {0.13, 1.435, 0.085}),
        on(1, {0.185, 1.40, 0.013})},
       0.02,
       0,
       0.8,
       {0, 1, 0},
       {chest}},
      {"pectoral",
       {on(0, {0.02, 1.36, 0.125}), on(0, {0.08, 1.39, 0.12}), on(0, {0.13, 1.415, 0.085}),
        on(1, {0.185, 1.385, 0.013})},
       0.02,
       0,
       0.8,
       {0, 1, 0},
       {chest}},
  };
}

// One muscle a part; parts of one name are strips of a sheet.
inline Anatomy arm_anatomy(double mirror = 1, double scale = 1, int slices = 13) {
  Anatomy anatomy;
  anatomy.skeleton = arm_skeleton(mirror, scale);
  const Eigen::DiagonalMatrix<double, 3> map(scale * mirror, scale, scale);
  for (ArmPart part : arm_parts()) {
    for (PathPoint& p : part.path) p.rest = map * p.rest;
    auto stations =
        spindle(slices, scale * part.radius, scale * 0.004, part.begin, part.end, map * part.width);
    for (Station& s : stations) s.offset = map * Vec3(0.001, 0.002, 0.0015);
    Strip strip = make_strip(part.path, stations);
    strip.belly_begin = part.begin;
    strip.belly_end = part.end;
    for (Wrap wrap : part.wraps) {
      wrap.X_WO.translation() = map * wrap.X_WO.translation();
      wrap.radii *= scale;
      strip.wraps.push_back(wrap);
    }
    if (anatomy.muscles.empty() || anatomy.muscles.back().name != part.name) {
      Muscle muscle;
      muscle.name = part.name;
      anatomy.muscles.push_back(muscle);
    } else {
      anatomy.muscles.back().sheet = true;
    }
    anatomy.muscles.back().strips.push_back(strip);
  }
  return anatomy;
}

// Angles in degrees: shoulder raised sideways and forward, turned about the arm; elbow flexed;
// forearm pronated.
inline Pose arm_pose(const Skeleton& skeleton, double side, double forward, double turn,
                     double elbow, double pronation, double mirror = 1) {
  const double deg = std::numbers::pi / 180;
  const auto about = [&](double angle, Vec3 axis) {
    // A mirrored turn: the axis as a pseudo vector.
    if (mirror < 0) axis = Vec3(axis.x(), -axis.y(), -axis.z());
    return Quat(Eigen::AngleAxisd(angle * deg, axis));
  };
  Pose pose = rest_pose(skeleton);
  pose.rotations[1] =
      about(side, Vec3::UnitZ()) * about(-forward, Vec3::UnitX()) * about(turn, Vec3::UnitY());
  pose.rotations[2] = about(-elbow, Vec3::UnitX());
  pose.rotations[3] = about(pronation, Vec3::UnitY());
  return pose;
}

}  // namespace ecorche::testing
