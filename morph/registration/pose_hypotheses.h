// Poses that people are scanned in, as first guesses.
#pragma once

#include <string>
#include <vector>

#include "morph/registration/articulated_body.h"

namespace ecorche::inline v1 {

// Where a limb points, in the frame of the body: +X its left, +Y up, +Z forward. For the left; the
// right one's mirror image.
struct LimbPose {
  const char* name;
  Vec3 upper, lower;  // of upper arm and forearm, or thigh and shank
};

const std::vector<LimbPose>& arm_poses();
const std::vector<LimbPose>& leg_poses();

// All that a limb can do, in coarse steps of where it points and how far it is bent which way.
const std::vector<LimbPose>& limb_grid(bool arm);

// Turns of one limb's joints so that it points so; all other joints stay. `arm`: else a leg.
void set_limb(const ArticulatedBody& body, bool arm, Side side, const LimbPose& limb,
              std::vector<Mat3>& turns);

struct BodyPose {
  std::string name;  // "arms down", "t-pose, one step"
  std::vector<Mat3> turns;
};

// Whole bodies: symmetric arms with several stances and trunks. The root is not turned.
std::vector<BodyPose> standing_poses(const ArticulatedBody& body);

}  // namespace ecorche::inline v1
