// The whole body's centre of mass from joint positions.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Segment masses and centres of Winter (Biomechanics and Motor Control of Human Movement, 4th
// edition, 2009) laid along our joints, the trunk in three parts.
class CenterOfMass {
 public:
  struct Segment {
    double mass;  // share of the body's
    int joint;    // that the segment moves with
    Vec3 centre;  // in that joint's frame, m
  };

  // Precondition (std::invalid_argument): the skeleton has our joints.
  explicit CenterOfMass(const Skeleton& skeleton);
  Vec3 operator()(const std::vector<Transform>& X_WJ) const;
  const std::vector<Segment>& segments() const { return segments_; }

 private:
  std::vector<Segment> segments_;
};

}  // namespace ecorche::inline v1
