#include "skinning/constraints/motion_limits.h"

#include <algorithm>

#include "anatomy/chain_kinematics.h"

namespace ecorche::inline v1 {
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

MotionLimiter::MotionLimiter(const Skeleton& skeleton, double sole_height,
                             const CollisionProxies* proxies)
    : skeleton_(skeleton), tables_(make_limit_tables(skeleton, sole_height)) {
  if (proxies != nullptr) collision_ = make_collision_tables(skeleton, *proxies);
  ends_.push_back({find_joint(skeleton, "head"), Vec3::Zero(), {.end = "head"}});
  for (const LimbChain& limb : tables_.limbs)
    ends_.push_back({limb.joints[3], limb.point, {.end = skeleton.joints[limb.joints[3]].name}});
}

void MotionLimiter::run(const LimbTolerance& tolerance, const std::vector<Contact>& contacts,
                        const std::vector<LimbShifts>& shifts, Motion& motion) {
  std::vector<Pose> given = motion.frames;
  std::vector<LimbShifts> wanted = shifts.empty() ? std::vector<LimbShifts>(given.size()) : shifts;
  tolerance_ = tolerance;
  stands_.assign(given.size(), {});
  for (const Contact& contact : contacts)
    for (int f = contact.begin; f < contact.end; ++f) {
      FootStand& foot = stands_[f][contact.side == Side::left ? 0 : 1];
      (contact.heel ? foot.heel : foot.ball) = true;
    }
  for (std::size_t f = 0; f < given.size(); ++f) {
    enforce_limits(skeleton_, tables_, tolerance_, stands_[f], wanted[f], motion.frames[f],
                   workspace_);
    for (std::size_t e = 0; e < ends_.size(); ++e) {
      End& end = ends_[e];
      const std::size_t j = end.joint;
      const Vec3 shift = e > 0 ? wanted[f][e - 1].end : Vec3(Vec3::Zero());
      const double moved =
          (workspace_.before[j] * end.point + shift - workspace_.after[j] * end.point).norm();
      end.move.mean += moved / double(given.size());
      if (moved > end.move.most) end.move.most = moved, end.move.worst_frame = int(f);
    }
  }
  if (tolerance.on_ground) raise_pelvis(given, wanted, motion);
  if (!collision_) return;
  if (initial_penetrations_.empty()) initial_penetrations_ = penetrations(motion);
  separate(given, wanted, motion);
}

void MotionLimiter::limit(std::size_t frame, const Pose& given, const LimbShifts& shifts,
                          Pose& pose) {
  pose = given;
  enforce_limits(skeleton_, tables_, tolerance_, stands_[frame], shifts, pose, workspace_);
}

void MotionLimiter::raise_pelvis(std::vector<Pose>& given, std::vector<LimbShifts>& shifts,
                                 Motion& motion) {
  constexpr int kPasses = 6;
  constexpr double kKneeTolerance = 0.015;  // m; a knee may be off its position by so much
  constexpr double kStep = 0.5;             // part of the excess that one pass raises the pelvis
  constexpr double kMaxRaise = 0.1;         // m, all passes together
  std::vector<Transform> before, after;
  std::vector<double> raised(given.size(), 0.0);
  const std::vector<int> joints =
      joints_up_from(skeleton_, {tables_.limbs[0].joints[1], tables_.limbs[1].joints[1]});
  std::vector<LimbShifts> more(given.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    for (std::size_t f = 0; f < given.size(); ++f) {
      // A frame that has not moved has its knees where they were.
      if (pass > 0 && !moves_any(more[f])) continue;
      more[f] = {};
      if (!stands_[f][0].heel && !stands_[f][0].ball && !stands_[f][1].heel && !stands_[f][1].ball)
        continue;
      chain_kinematics(skeleton_, joints, given[f], before);
      chain_kinematics(skeleton_, joints, motion.frames[f], after);
      double off = 0;
      for (std::size_t l = 0; l < 2; ++l) {
        if (!stands_[f][l].heel && !stands_[f][l].ball) continue;
        const std::size_t knee = tables_.limbs[l].joints[1];
        off = std::max(
            off,
            (before[knee].translation() + shifts[f][l].middle - after[knee].translation()).norm());
      }
      const Vec3 up(0, std::clamp(kStep * (off - kKneeTolerance), 0.0, kMaxRaise - raised[f]), 0);
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

void MotionLimiter::separate(const std::vector<Pose>& given, const std::vector<LimbShifts>& shifts,
                             Motion& motion) {
  constexpr int kPasses = 4;
  std::vector<LimbShifts> found(given.size()), more(given.size());
  std::vector<Transform> X;
  for (int pass = 0; pass < kPasses; ++pass) {
    for (std::size_t f = 0; f < given.size(); ++f) {
      // A pose that has not moved is apart as it was.
      if (pass > 0 && !moves_any(more[f])) continue;
      chain_kinematics(skeleton_, tables_.needed, motion.frames[f], X);
      more[f] = separate_limbs(*collision_, X);
      if (tolerance_.on_ground) more[f][0].end.setZero(), more[f][1].end.setZero();
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

std::vector<EndMove> MotionLimiter::end_moves() const {
  std::vector<EndMove> out;
  for (const End& end : ends_) out.push_back(end.move);
  return out;
}

std::vector<Penetration> MotionLimiter::penetrations(const Motion& motion) const {
  constexpr double kReported = 2e-3;  // m; a shallower frame is not counted
  std::vector<Penetration> out;
  if (!collision_) return out;
  for (const char* name : kCollisionNames) out.push_back({.what = name});
  std::vector<Transform> X;
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    chain_kinematics(skeleton_, tables_.needed, motion.frames[f], X);
    const PenetrationDepths depths = penetration_depths(*collision_, X);
    for (std::size_t k = 0; k < depths.size(); ++k) {
      out[k].frames += depths[k] > kReported;
      if (depths[k] > out[k].worst) out[k].worst = depths[k], out[k].worst_frame = int(f);
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
