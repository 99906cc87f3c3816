// A jointed arm for tests of the skin: a tube of skin around two capsule bones and, if wanted, a
// biceps that spans the elbow.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "anatomy/anatomy.h"

namespace ecorche::test {

// A closed surface of revolution about a straight axis from a, along unit w, through (distance
// along, radius) pairs.
inline TriMesh lathe(const Vec3& a, const Vec3& w, const std::vector<Vec2>& profile, int sides) {
  const Vec3 u = w.unitOrthogonal(), v = w.cross(u);
  const int rings = profile.size();
  TriMesh mesh;
  mesh.V.resize(rings * sides + 2, 3);
  mesh.F.resize(2 * rings * sides, 3);
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < sides; ++s) {
      const double angle = 2 * std::numbers::pi * s / sides;
      const Vec2 p = profile[r];
      mesh.V.row(r * sides + s) =
          a + w * p.x() + p.y() * (u * std::cos(angle) + v * std::sin(angle));
    }
  const int first = rings * sides, last = first + 1;
  mesh.V.row(first) = a + w * profile.front().x();
  mesh.V.row(last) = a + w * profile.back().x();
  int f = 0;
  for (int s = 0; s < sides; ++s) {
    const int n = (s + 1) % sides;
    mesh.F.row(f++) << first, n, s;
    mesh.F.row(f++) << last, (rings - 1) * sides + s, (rings - 1) * sides + n;
    for (int r = 0; r + 1 < rings; ++r) {
      mesh.F.row(f++) << r * sides + s, r * sides + n, (r + 1) * sides + n;
      mesh.F.row(f++) << r * sides + s, (r + 1) * sides + n, (r + 1) * sides + s;
    }
  }
  return mesh;
}

inline TriMesh capsule(const Vec3& a, const Vec3& b, double radius, int sides = 12) {
  const double length = (b - a).norm();
  std::vector<Vec2> profile;
  for (int k = 1; k <= 4; ++k) {
    const double angle = std::numbers::pi / 2 * (1 - k / 4.0);
    profile.emplace_back(-radius * std::sin(angle), radius * std::cos(angle));
  }
  for (int k = 1; k < 6; ++k) profile.emplace_back(length * k / 6, radius);
  for (int k = 0; k < 4; ++k) {
    const double angle = std::numbers::pi / 2 * k / 4;
    profile.emplace_back(length + radius * std::sin(angle), radius * std::cos(angle));
  }
  return lathe(a, (b - a) / length, profile, sides);
}

// Hangs along -y on the side `sign` (+1 left) of the mid-plane: shoulder at (0.2 sign, 1.4, 0),
// elbow 0.3 below it, wrist another 0.26. Skin radius 45 mm. The hinge of the elbow is the x axis;
// a positive turn of -x bends the forearm forward.
struct Arm {
  Anatomy anatomy;
  TriMesh skin;
};

inline Joint make_joint(const std::string& name, int parent, const Vec3& offset, double range) {
  Joint joint;
  joint.name = name;
  joint.parent = parent;
  joint.X_PJ.translation() = offset;
  joint.min = Vec3::Constant(-range / 2);
  joint.max = Vec3::Constant(range / 2);
  return joint;
}

inline Arm make_arm(double sign = 1, bool muscle = true, int rings = 60, int sides = 32) {
  const std::string side = sign > 0 ? "_l" : "_r";
  const Vec3 shoulder(0.2 * sign, 1.4, 0), elbow = shoulder - Vec3(0, 0.3, 0),
                                           wrist = elbow - Vec3(0, 0.26, 0);
  Arm arm;
  arm.anatomy.skeleton.joints = {make_joint("pelvis", -1, {0, 1, 0}, 0.1),
                                 make_joint("thorax", 0, {0, 0.3, 0}, 0.2),
                                 make_joint("shoulder" + side, 1, shoulder - Vec3(0, 1.3, 0), 3),
                                 make_joint("elbow" + side, 2, elbow - shoulder, 2.6),
                                 make_joint("wrist" + side, 3, wrist - elbow, 2)};
  const Side s = sign > 0 ? Side::left : Side::right;
  arm.anatomy.bones = {{"humerus" + side, s, 2, capsule(shoulder - Vec3(0, 0.02, 0), elbow, 0.012)},
                       {"ulna" + side, s, 3, capsule(elbow - Vec3(0, 0.02, 0), wrist, 0.01)}};
  if (muscle) {
    Strip strip;
    strip.path = {{shoulder + Vec3(0, -0.03, 0.02), {2, -1}, 1},
                  {elbow + Vec3(0, 0.06, 0.024), {2, -1}, 1},
                  {elbow + Vec3(0, -0.04, 0.012), {3, -1}, 1}};
    for (int k = 0; k <= 12; ++k) {
      const double t = k / 12.0, r = 0.004 + 0.014 * std::sin(std::numbers::pi * t);
      strip.slices.push_back({t, 0, Vec2::Zero(), Vec2(r, 0.8 * r)});
    }
    Muscle biceps;
    biceps.name = "biceps" + side;
    biceps.side = s;
    biceps.strips = {strip};
    biceps.origin_bone = "humerus" + side;
    biceps.insertion_bone = "ulna" + side;
    arm.anatomy.muscles = {biceps};
  }
  std::vector<Vec2> profile;
  for (int k = 0; k <= rings; ++k) {
    const double t = double(k) / rings, end = std::min(t, 1 - t) * 12;
    profile.emplace_back(-0.03 + 0.62 * t, 0.045 * std::sqrt(std::min(1.0, end + 0.05)));
  }
  arm.skin = lathe(shoulder, Vec3(0, -1, 0), profile, sides);
  return arm;
}

}  // namespace ecorche::test
