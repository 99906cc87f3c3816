// Points of a body's skin that may come down on the ground: those that stand out furthest around
// each bone. Each moves with one joint.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Points of one joint.
struct GroundPatch {
  int joint = -1;
  std::vector<Vec3> points;  // in the joint's frame, m
  double reach = 0;          // of the furthest from the joint, m
};

struct GroundPoints {
  std::vector<GroundPatch> body;  // trunk, head, shoulders, thighs, knees, shanks
  // Left and right: around the elbow, from there to the knuckles, fingers and thumb, feet.
  std::array<std::vector<GroundPatch>, 2> elbows, hands, fingers, feet;
};

// Of the skin at rest, #V x 3; a vertex belongs to the bone whose axis is nearest. Precondition
// (std::invalid_argument): the skeleton has our joints.
GroundPoints measure_ground_points(const Skeleton& skeleton, const Points& skin);

}  // namespace ecorche::inline v1
