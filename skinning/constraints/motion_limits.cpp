#include "skinning/constraints/motion_limits.h"

#include <algorithm>

#include "anatomy/chain_kinematics.h"

namespace ecorche::inline v1 {
namespace {

LimbShifts sum(LimbShifts a, const LimbShifts& b) {
  for (std::size_t l = 0; l < a.size(); ++l) a[l].middle += b[l].middle, a[l].end += b[l].end;
  return a;
}

bool moves(const LimbShift& one) { return !one.middle.isZero(0) || !one.end.isZero(0); }

bool moves_any(const LimbShifts& shifts) { return std::ranges::any_of(shifts, moves); }

bool same(const Pose& a, const Pose& b) {
  return a.root == b.root && std::ranges::equal(a.rotations, b.rotations, [](auto& p, auto& q) {
           return p.coeffs() == q.coeffs();
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
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j)
    if (tables_.kept[j] > 1 || skeleton.joints[j].name.starts_with("patella"))
      limb_joints_.push_back(int(j));
}

void MotionLimiter::run(const LimbTolerance& tolerance, const std::vector<Contact>& contacts,
                        const std::vector<LimbShifts>& shifts, Motion& motion, bool legs_alone) {
  std::vector<Pose> given = motion.frames;
  std::vector<LimbShifts> wanted = shifts.empty() ? std::vector<LimbShifts>(given.size()) : shifts;
  if (tolerance != tolerance_ || legs_alone != legs_alone_) limited_.clear();
  limited_.resize(given.size());
  tolerance_ = tolerance;
  legs_alone_ = legs_alone;
  stands_.assign(given.size(), {});
  for (const Contact& contact : contacts)
    for (int f = contact.begin; f < contact.end; ++f) {
      FootStand& foot = stands_[f][contact.side == Side::left ? 0 : 1];
      (contact.heel ? foot.heel : foot.ball) = true;
    }
  for (std::size_t f = 0; f < given.size(); ++f) {
    limit(f, wanted[f], motion.frames[f]);
    for (std::size_t e = 0; e < ends_.size(); ++e) {
      EndMove& move = ends_[e].move;
      const double moved = limited_[f].moved[e];
      move.mean += moved / double(given.size());
      if (moved > move.most) move.most = moved, move.worst_frame = int(f);
    }
  }
  if (tolerance.on_ground) raise_pelvis(given, wanted, motion);
  if (!collision_) return;
  if (initial_penetrations_.empty()) initial_penetrations_ = penetrations(motion);
  separate(given, wanted, motion);
}

void MotionLimiter::limit(std::size_t frame, const LimbShifts& shifts, Pose& pose) {
  Limited& last = limited_[frame];
  last.followed = 0;
  last.as_before = last.stands == stands_[frame] && last.shifts == shifts && same(last.given, pose);
  if (last.as_before) {
    pose = last.pose;
    return;
  }
  last.renewals.clear();
  last.given = pose;
  last.shifts = shifts;
  last.stands = stands_[frame];
  std::array<bool, 4> which{true, true, true, true};
  if (legs_alone_) {
    which = {true, true, moves(shifts[2]), moves(shifts[3])};
    renew_limbs(skeleton_, tables_, tolerance_, stands_[frame], shifts, which, last.given, pose,
                workspace_);
  } else {
    enforce_limits(skeleton_, tables_, tolerance_, stands_[frame], shifts, pose, workspace_);
  }
  last.pose = pose;
  for (std::size_t e = 0; e < ends_.size(); ++e) {
    const End& end = ends_[e];
    const std::size_t j = std::size_t(end.joint);
    const Vec3 shift = e > 0 ? shifts[e - 1].end : Vec3(Vec3::Zero());
    const bool stays = e > 0 ? !which[e - 1] : legs_alone_;
    last.moved[e] =
        stays ? 0
              : (workspace_.before[j] * end.point + shift - workspace_.after[j] * end.point).norm();
  }
}

void MotionLimiter::renew(std::size_t frame, const Pose& given, const LimbShifts& shifts,
                          const std::array<bool, 4>& which, Pose& pose) {
  Limited& last = limited_[frame];
  pose.root = given.root;
  if (last.as_before && last.followed < last.renewals.size()) {
    const Renewal& next = last.renewals[last.followed];
    if (next.root == given.root && next.which == which && next.shifts == shifts) {
      for (std::size_t k = 0; k < limb_joints_.size(); ++k)
        pose.rotations[std::size_t(limb_joints_[k])] = next.rotations[k];
      ++last.followed;
      return;
    }
  }
  last.as_before = false;
  last.renewals.resize(last.followed++);
  renew_limbs(skeleton_, tables_, tolerance_, stands_[frame], shifts, which, given, pose,
              workspace_);
  Renewal& made = last.renewals.emplace_back(Renewal{given.root, shifts, which, {}});
  for (const int j : limb_joints_) made.rotations.push_back(pose.rotations[std::size_t(j)]);
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
      renew(f, given[f], shifts[f], {true, true, false, false}, motion.frames[f]);
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
      std::array<bool, 4> which{};
      for (std::size_t l = 0; l < which.size(); ++l) which[l] = moves(more[f][l]);
      renew(f, given[f], sum(shifts[f], found[f]), which, motion.frames[f]);
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
