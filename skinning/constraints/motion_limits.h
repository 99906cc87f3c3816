// A whole motion within its limits: joints (skinning/constraints/joint_limits.h), and limbs that do
// not pass through the body (skinning/constraints/self_collision.h).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/joint_limits.h"
#include "skinning/constraints/self_collision.h"
#include "skinning/retarget/retarget.h"

namespace ecorche {

class MotionLimiter {
 public:
  // The skeleton is kept by reference. Without `rounds` limbs are not kept apart.
  MotionLimiter(const Skeleton& skeleton, double sole_height, const BodyRounds* rounds);

  // Every frame is brought within limits with its limbs shifted (`shifts`: a frame each, or none),
  // then limbs that meet are parted: what parts them is found on the motion as it is, smoothed over
  // time, and topped up with it in place, in turns. `contacts`: of the feet that stand. Feet on the
  // ground (hold.ground) are planted already and stay: only knees give way then, and where hip and
  // ankle together bend no further, so that a knee would have to leave its place, the pelvis comes
  // up.
  void run(const LimbHold& hold, const std::vector<Contact>& contacts,
           const std::vector<LimbShifts>& shifts, Motion& motion);

  // By how much keeping limits moved the ends of limbs, over all runs; parting them is not counted.
  std::vector<EndMove> moves() const;

  // How deep parts lay in one another in the first run before they were parted, and how deep they
  // lie in any motion: an entry for each of kMeetingNames; none without rounds.
  const std::vector<MeetingBreak>& parted() const { return parted_; }
  std::vector<MeetingBreak> meetings(const Motion& motion) const;

 private:
  struct End {
    int joint;
    Vec3 point;
    EndMove move;
  };
  void limit(std::size_t frame, const Pose& given, const LimbShifts& shifts, Pose& pose);
  void raise_pelvis(std::vector<Pose>& given, std::vector<LimbShifts>& shifts, Motion& motion);
  void part(const std::vector<Pose>& given, const std::vector<LimbShifts>& shifts, Motion& motion);

  const Skeleton& skeleton_;
  LimitTables tables_;
  std::optional<ApartTables> apart_;
  LimitScratch scratch_;
  LimbHold hold_;
  std::vector<std::array<FootStand, 2>> stands_;  // a frame
  std::vector<End> ends_;
  std::vector<MeetingBreak> parted_;
};

}  // namespace ecorche
