#include "skinning/constraints/motion_limits.h"

#include <algorithm>

namespace ecorche {
namespace {

LimbShifts sum(LimbShifts a, const LimbShifts& b) {
  for (std::size_t l = 0; l < a.size(); ++l) a[l].middle += b[l].middle, a[l].end += b[l].end;
  return a;
}

bool moves_any(const LimbShifts& shifts) {
  return std::any_of(shifts.begin(), shifts.end(), [](const LimbShift& one) {
    return !one.middle.isZero(0) || !one.end.isZero(0);
  });
}

}  // namespace

MotionLimiter::MotionLimiter(const Skeleton& skeleton, double sole_height, const BodyRounds* rounds)
    : skeleton_(skeleton), tables_(make_limit_tables(skeleton, sole_height)) {
  if (rounds != nullptr) apart_ = make_apart_tables(skeleton, *rounds);
  ends_.push_back({find_joint(skeleton, "head"), Vec3::Zero(), {.end = "head"}});
  for (const LimbChain& limb : tables_.limbs)
    ends_.push_back({limb.joints[3], limb.point, {.end = skeleton.joints[limb.joints[3]].name}});
}

void MotionLimiter::run(const LimbHold& hold, const std::vector<Contact>& contacts,
                        const std::vector<LimbShifts>& shifts, Motion& motion) {
  std::vector<Pose> given = motion.frames;
  std::vector<LimbShifts> placed = shifts.empty() ? std::vector<LimbShifts>(given.size()) : shifts;
  hold_ = hold;
  stands_.assign(given.size(), {});
  for (const Contact& contact : contacts)
    for (int f = contact.begin; f < contact.end; ++f) {
      FootStand& foot = stands_[f][contact.side == Side::left ? 0 : 1];
      (contact.heel ? foot.heel : foot.ball) = true;
    }
  for (std::size_t f = 0; f < given.size(); ++f) {
    keep_limits(skeleton_, tables_, hold_, stands_[f], placed[f], motion.frames[f], scratch_);
    for (std::size_t e = 0; e < ends_.size(); ++e) {
      End& end = ends_[e];
      const std::size_t j = end.joint;
      const Vec3 shift = e > 0 ? placed[f][e - 1].end : Vec3(Vec3::Zero());
      const double moved =
          (scratch_.before[j] * end.point + shift - scratch_.after[j] * end.point).norm();
      end.move.mean += moved / double(given.size());
      if (moved > end.move.most) end.move.most = moved, end.move.worst_frame = int(f);
    }
  }
  if (hold.ground) raise_pelvis(given, placed, motion);
  if (!apart_) return;
  if (parted_.empty()) parted_ = meetings(motion);
  part(given, placed, motion);
}

void MotionLimiter::limit(std::size_t frame, const Pose& given, const LimbShifts& shifts,
                          Pose& pose) {
  pose = given;
  keep_limits(skeleton_, tables_, hold_, stands_[frame], shifts, pose, scratch_);
}

void MotionLimiter::raise_pelvis(std::vector<Pose>& given, std::vector<LimbShifts>& shifts,
                                 Motion& motion) {
  constexpr int kTurns = 6;
  constexpr double kNear = 0.015, kShare = 0.5,
                   kMost = 0.1;  // m off its place that a knee may be; how much of the rest; m
  std::vector<Transform> before, after;
  std::vector<double> raised(given.size(), 0.0);
  for (int turn = 0; turn < kTurns; ++turn) {
    std::vector<LimbShifts> more(given.size());
    for (std::size_t f = 0; f < given.size(); ++f) {
      forward_kinematics(skeleton_, given[f], before);
      forward_kinematics(skeleton_, motion.frames[f], after);
      double off = 0;
      for (std::size_t l = 0; l < 2; ++l) {
        if (!stands_[f][l].heel && !stands_[f][l].ball) continue;
        const std::size_t knee = tables_.limbs[l].joints[1];
        off = std::max(
            off,
            (before[knee].translation() + shifts[f][l].middle - after[knee].translation()).norm());
      }
      const Vec3 up(0, std::clamp(kShare * (off - kNear), 0.0, kMost - raised[f]), 0);
      more[f][0] = more[f][1] = {-0.5 * up, -up};  // as the legs see it, whose feet stay
    }
    if (std::none_of(more.begin(), more.end(), moves_any)) return;
    smooth_shifts(motion.fps, more);
    for (std::size_t f = 0; f < given.size(); ++f) {
      if (!moves_any(more[f])) continue;
      shifts[f] = sum(shifts[f], more[f]);
      given[f].root -= more[f][0].end;
      raised[f] -= more[f][0].end.y();
      limit(f, given[f], shifts[f], motion.frames[f]);
    }
  }
}

void MotionLimiter::part(const std::vector<Pose>& given, const std::vector<LimbShifts>& shifts,
                         Motion& motion) {
  constexpr int kTurns = 4;
  std::vector<LimbShifts> found(given.size()), more(given.size());
  std::vector<Transform> X;
  for (int turn = 0; turn < kTurns; ++turn) {
    for (std::size_t f = 0; f < given.size(); ++f) {
      forward_kinematics(skeleton_, motion.frames[f], X);
      more[f] = part_limbs(*apart_, X);
      if (hold_.ground) more[f][0].end.setZero(), more[f][1].end.setZero();
    }
    if (std::none_of(more.begin(), more.end(), moves_any)) return;
    smooth_shifts(motion.fps, more);
    for (std::size_t f = 0; f < given.size(); ++f) {
      if (!moves_any(more[f])) continue;
      found[f] = sum(found[f], more[f]);
      limit(f, given[f], sum(shifts[f], found[f]), motion.frames[f]);
    }
  }
}

std::vector<EndMove> MotionLimiter::moves() const {
  std::vector<EndMove> out;
  for (const End& end : ends_) out.push_back(end.move);
  return out;
}

std::vector<MeetingBreak> MotionLimiter::meetings(const Motion& motion) const {
  constexpr double kTold = 2e-3;  // m
  std::vector<MeetingBreak> out;
  if (!apart_) return out;
  for (const char* name : kMeetingNames) out.push_back({.what = name});
  std::vector<Transform> X;
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    forward_kinematics(skeleton_, motion.frames[f], X);
    const MeetingDepths depths = meeting_depths(*apart_, X);
    for (std::size_t k = 0; k < depths.size(); ++k) {
      out[k].frames += depths[k] > kTold;
      if (depths[k] > out[k].worst) out[k].worst = depths[k], out[k].worst_frame = int(f);
    }
  }
  return out;
}

}  // namespace ecorche
