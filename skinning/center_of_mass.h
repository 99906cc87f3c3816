// The whole body's centre of mass from joint positions.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche {

// Segment masses and centres of de Leva (1996, 10.1016/0021-9290(95)00178-6), mean of both sexes, laid along our joints.
class CenterOfMass {
 public:
  // Precondition (std::invalid_argument): the skeleton has our joints.
  explicit CenterOfMass(const Skeleton& skeleton);
  Vec3 operator()(const std::vector<Transform>& X_WJ) const;

 private:
  struct Segment {
    double mass;
    int joint;   // carries the segment
    Vec3 place;  // of its centre in that joint's frame
  };
  std::vector<Segment> segments_;
};

}  // namespace ecorche
