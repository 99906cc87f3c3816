// Constraints over a whole motion: joint limits (joint_limits.h) and self-collision
// (self_collision.h).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/joint_limits.h"
#include "skinning/constraints/motion_report.h"
#include "skinning/constraints/self_collision.h"

namespace ecorche::inline v1 {

class MotionLimiter {
 public:
  // The skeleton is kept by reference. `proxies` null: self-collision is left as it is.
  MotionLimiter(const Skeleton& skeleton, double sole_height, const CollisionProxies* proxies);

  // Enforces the limits in every frame, with its limbs shifted (`shifts`: one a frame, or none).
  // Then resolves self-collision: shifts are found on the motion as it is, smoothed over time, and
  // found again with them in place, in alternation. `contacts`: of the standing feet. With
  // tolerance.on_ground the feet are planted already and stay: only knees are shifted, and where
  // hip and ankle together reach their limits, so that a knee would have to leave its position, the
  // pelvis is raised.
  void run(const LimbTolerance& tolerance, const std::vector<Contact>& contacts,
           const std::vector<LimbShifts>& shifts, Motion& motion);

  const LimitTables& tables() const { return tables_; }

  // Displacement of the ends of limbs by the limits, over all runs; without self-collision.
  std::vector<EndMove> end_moves() const;

  // Self-collision in the first run before it was resolved, and in any motion: an entry for each of
  // kCollisionNames; none without proxies.
  const std::vector<Penetration>& initial_penetrations() const { return initial_penetrations_; }
  std::vector<Penetration> penetrations(const Motion& motion) const;

 private:
  struct End {
    int joint;
    Vec3 point;
    EndMove move;
  };
  void limit(std::size_t frame, const Pose& given, const LimbShifts& shifts, Pose& pose);
  void raise_pelvis(std::vector<Pose>& given, std::vector<LimbShifts>& shifts, Motion& motion);
  void separate(const std::vector<Pose>& given, const std::vector<LimbShifts>& shifts,
                Motion& motion);

  const Skeleton& skeleton_;
  LimitTables tables_;
  std::optional<SelfCollisionTables> collision_;
  LimitWorkspace workspace_;
  LimbTolerance tolerance_;
  std::vector<std::array<FootStand, 2>> stands_;  // a frame
  std::vector<End> ends_;
  std::vector<Penetration> initial_penetrations_;
};

}  // namespace ecorche::inline v1
