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
  // pelvis is raised. `legs_alone`: trunk and arms are inside their limits already, as an earlier
  // run has left them, and stay, arms that are shifted excepted.
  void run(const LimbTolerance& tolerance, const std::vector<Contact>& contacts,
           const std::vector<LimbShifts>& shifts, Motion& motion, bool legs_alone = false);

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
  // Limbs that were brought inside anew, and the rotations of `limb_joints_` that came of it.
  struct Renewal {
    Vec3 root;
    LimbShifts shifts;
    std::array<bool, 4> which;
    std::vector<Quat> rotations;
  };
  // What a frame was made of and what became of it.
  struct Limited {
    Pose given;
    LimbShifts shifts;
    std::array<FootStand, 2> stands;
    Pose pose;
    std::array<double, 5> moved{};  // ends, m
    std::vector<Renewal> renewals;  // after that, in their order
    std::size_t followed = 0;       // of them, in this run
    bool as_before = false;         // so far this run has met what the last one did
  };
  void limit(std::size_t frame, const LimbShifts& shifts, Pose& pose);
  void renew(std::size_t frame, const Pose& given, const LimbShifts& shifts,
             const std::array<bool, 4>& which, Pose& pose);
  void raise_pelvis(std::vector<Pose>& given, std::vector<LimbShifts>& shifts, Motion& motion);
  void separate(const std::vector<Pose>& given, const std::vector<LimbShifts>& shifts,
                Motion& motion);

  const Skeleton& skeleton_;
  LimitTables tables_;
  std::optional<SelfCollisionTables> collision_;
  LimitWorkspace workspace_;
  LimbTolerance tolerance_;
  bool legs_alone_ = false;
  std::vector<std::array<FootStand, 2>> stands_;  // a frame
  std::vector<End> ends_;
  std::vector<int> limb_joints_;  // of limbs, with toes and patellae
  // A frame, of the last run with this tolerance: frames that have not changed come out as they
  // did.
  std::vector<Limited> limited_;
  std::vector<Penetration> initial_penetrations_;
};

}  // namespace ecorche::inline v1
