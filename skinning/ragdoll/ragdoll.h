// A body whose muscles let go: segments on damped joints, points of its skin that meet the ground,
// and limbs that keep out of each other.
//
// Joints have what relaxed muscles resist with, a few N m within the range and steeply more before
// the limits (Riener and Edrich 1999, 10.1016/S0021-9290(99)00044-3, for the order; sizes here are
// rounded), about a loose pose; tone adds springs towards the pose that the body had.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "skinning/binding.h"
#include "skinning/constraints/self_collision.h"
#include "skinning/multibody/articulated_body.h"

namespace ecorche::inline v1 {

struct CarriedPoint {
  int joint = 0;              // that carries it
  Vec3 place = Vec3::Zero();  // in the joint's frame, m
};

// A finger's joint and how it is turned when nothing holds it.
struct LooseFinger {
  int joint = 0;
  Quat rotation = Quat::Identity();
};

struct Ragdoll {
  ArticulatedModel body;
  std::vector<CarriedPoint> points;  // outermost ones of what each joint carries
  SelfCollisionTables limbs;
  std::vector<LooseFinger> fingers;
};

// `weights`: #V of the skin. Joints of `rigid` stay as they are in the pose that a simulation
// begins with, and so does a spine or neck of which a joint is named. Preconditions
// (std::invalid_argument): our joints, a row of weights a vertex.
Ragdoll make_ragdoll(const Skeleton& skeleton, const std::vector<BodySegment>& segments,
                     const Points& skin, std::span<const JointWeights> weights,
                     const std::vector<std::string>& rigid = {});

// Resistance of the joints. `tone` of the muscles: 0 limp, 1 tense. The springs' rest lies between
// a loose pose and `pose`, by their strengths.
PassiveRest set_tone(double tone, const Pose& pose, ArticulatedModel& body);

// Fingers weigh nothing and are no freedoms: they curl by a share of the way to where loose ones
// are.
void loosen_fingers(const Ragdoll& ragdoll, double share, Pose& pose);

// No resistance at all, and no limits: for comparison with closed solutions.
PassiveRest set_frictionless(const Pose& pose, ArticulatedModel& body);

}  // namespace ecorche::inline v1
