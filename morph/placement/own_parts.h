// Joints and bones of a template that the built-in skeleton lacks: they go with what they hang on.
#pragma once

#include <cstddef>
#include <vector>

#include "anatomy/anatomy.h"
#include "morph/placement/fitted_skeleton.h"

namespace ecorche::inline v1 {

// Preconditions: the joints of `own` begin with those of `built_in`; `warp` carries `built_in`.
class OwnParts {
 public:
  // All borrowed.
  OwnParts(const Anatomy& own, const Anatomy& built_in, const SkeletonWarp& warp);

  // The joint of the built-in skeleton that a joint goes with: itself, or the nearest above.
  int carrier(int joint) const { return carriers_[std::size_t(joint)]; }
  Vec3 carry(const Vec3& x, int joint) const { return warp_.by_joint(carrier(joint), x); }

  // To an anatomy that has the built-in joints and bones in place: joints of `own` behind them, and
  // of the bones those that `own` has. Bones of the same name and vertices stay as they are placed.
  void add_to(Anatomy& out) const;

 private:
  const Anatomy& own_;
  const Anatomy& built_in_;
  const SkeletonWarp& warp_;
  std::vector<int> carriers_;
};

}  // namespace ecorche::inline v1
