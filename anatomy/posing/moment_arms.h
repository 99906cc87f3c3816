// How muscles pull at joints: by how much a strip's line shortens when a joint turns.
#pragma once

#include <Eigen/Core>

#include <memory>
#include <vector>

#include "anatomy/posing/posing_table.h"

namespace ecorche::inline v1 {

// A turn of a joint about an axis of its own frame.
struct TurnAxis {
  int joint = 0;
  Vec3 direction = Vec3::UnitX();  // unit
};

// One strip that an axis moves, m: what it shortens by a radian. Positive: it pulls the way the
// turn goes.
struct MomentArm {
  int axis = 0, strip = 0;
};

// Which strips pass which axes: made once, read every frame. Lines are those that pose_anatomy()
// lays, so that wraps and points that keep their order count; a patella goes with its knee.
class MomentArms {
 public:
  // Precondition (std::invalid_argument): the table is of that skeleton, axes are the skeleton's.
  MomentArms(const PosingTable& table, const Skeleton& skeleton, std::vector<TurnAxis> axes);
  ~MomentArms();

  // Axis by axis.
  const std::vector<MomentArm>& pairs() const;

  // `lengths`: #strips, of the posed lines as pose_anatomy() has them, m; `arms`: #pairs, m. Both
  // are resized once and then reused.
  void find(const Pose& pose, std::vector<double>& lengths, std::vector<float>& arms) const;

 private:
  struct Plan;
  std::unique_ptr<const Plan> plan_;
};

}  // namespace ecorche::inline v1
