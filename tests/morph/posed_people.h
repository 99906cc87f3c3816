// People of the shape space stood in poses of every day, with known places of skin and joints.
//
// They are posed by a rig of the package and smoothed as cartoons are (delta mush), so that neither
// elbows nor hips collapse: not by the blend that registration itself uses.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/body_package.h"
#include "anatomy/base_mesh/body_rig.h"

namespace ecorche {

// Directions are world: +X the body's left, +Y up, +Z forwards. [0] left, [1] right.
struct StandingPose {
  std::string name;
  Vec3 arm[2], forearm[2], thigh[2], shank[2];
  Vec3 hand[2] = {Vec3::Zero(), Vec3::Zero()};     // zero: as the forearm carries it
  double pronation[2] = {0, 0};                    // rad
  double curl[2] = {0, 0};                         // of each finger joint, rad
  Vec3 spine = Vec3::Zero(), head = Vec3::Zero();  // turns, rad: axis times angle
  Mat3 hand_jitter[2] = {Mat3::Identity(), Mat3::Identity()},
       foot_jitter[2] = {Mat3::Identity(), Mat3::Identity()};
};

// A, T, arms down, hands on hips, an arm raised, a step, feet together, feet apart; each joint up
// to 20 degrees off.
StandingPose random_standing_pose(std::mt19937& random);

struct PosedPerson {
  Points skin;                   // #skin x 3, soles on y = 0
  std::vector<Landmark> joints;  // segment names as registration has them: "thigh_l"; posed
};

class PersonPoser {
 public:
  // rig: "default" or "game_engine".
  PersonPoser(const BodyPackage& package, const std::string& rig);
  // rest: #skin x 3 in the base mesh's rest pose. Arms and legs that would lie in the trunk or in
  // each other are spread.
  PosedPerson pose(const Points& rest, StandingPose pose) const;

 private:
  struct Placed;
  Placed place(const Points& rest, const StandingPose& pose) const;
  Points carried(const Points& from, const Points& rest) const;
  Points smoothed(const Points& points) const;
  std::vector<Mat3> frames(const Points& points) const;

  const BodyPackage& package_;
  Rig rig_;
  std::vector<VertexPart> parts_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<int> outer_;
  std::vector<std::string> joint_names_;
  Points joint_heads_;            // in the package's own shape
  std::vector<int> joint_bones_;  // of rig_
};

}  // namespace ecorche
