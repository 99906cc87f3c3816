#include "skinning/constraints/steady_limbs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "anatomy/chain_kinematics.h"
#include "anatomy/compute/smooth_step.h"
#include "anatomy/joint_angles.h"
#include "skinning/constraints/span_speed.h"
#include "skinning/constraints/temporal_smoothing.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kFaster = 1.45;                    // times the top speed
constexpr double kSlow = 0.8;                       // m/s; a joint may always be so fast
constexpr double kFasterHere = 3, kByMoreHere = 2;  // m/s; than around the step
constexpr double kAround = 0.15;                    // s
constexpr double kNarrow = 0.05;                    // s; half the width of the first mean
constexpr int kRounds = 4;                          // each of twice the width
constexpr double kFade = 0.1;                       // s; around a stance, as planting fades
constexpr double kMostRise = 8 * kDegree;           // of a heel whose ball stands
constexpr LimbTolerance kStanding{2e-3, 4 * kDegree, true};

using Angles = Eigen::VectorXd;  // three a joint

// Joints that move over together, and those whose speed is seen.
struct Chain {
  std::vector<std::size_t> joints;
  std::array<std::size_t, 2> seen{};
  std::vector<int> above;           // those joints and all above them
  const LimbChain* leg = nullptr;   // itself, of a leg
  std::vector<FootStand> standing;  // a frame; of a leg, else none
};

// Of the trunk with neck and head, whose leaps limbs would have to make up for, then of limbs.
std::vector<Chain> chains_of(const Skeleton& skeleton, const LimitTables& tables,
                             const std::vector<Contact>& contacts, std::size_t frames) {
  std::vector<Chain> out(1);
  const int head = find_joint(skeleton, "head");
  for (int j = head; j > 0; j = skeleton.joints[std::size_t(j)].parent)
    out[0].joints.push_back(std::size_t(j));
  out[0].seen = {std::size_t(tables.thorax), std::size_t(head)};
  for (const LimbChain& limb : tables.limbs) {
    Chain& chain = out.emplace_back();
    for (const int j : limb.joints) chain.joints.push_back(std::size_t(j));
    chain.seen = {chain.joints[1], chain.joints[limb.leg ? 2 : 3]};
    if (!limb.leg) continue;
    chain.leg = &limb;
    chain.standing.resize(frames);
  }
  for (Chain& chain : out)
    chain.above =
        joints_up_from(skeleton, std::vector<int>(chain.joints.begin(), chain.joints.end()));
  for (const Contact& contact : contacts)  // legs come after the trunk
    for (int f = contact.begin; f < contact.end; ++f) {
      FootStand& foot = out[contact.side == Side::left ? 1 : 2].standing[std::size_t(f)];
      (contact.heel ? foot.heel : foot.ball) = true;
    }
  return out;
}

// Positions of what is seen of a chain, from the pelvis.
using LimbPoints = std::array<Vec3, 2>;

LimbPoints limb_points(const Chain& chain, const std::vector<Transform>& X) {
  const Vec3 from = X[0].translation();
  return {X[chain.seen[0]].translation() - from, X[chain.seen[1]].translation() - from};
}

std::vector<LimbPoints> limb_path(const Skeleton& skeleton, const Chain& chain,
                                  const Motion& motion) {
  std::vector<LimbPoints> out;
  std::vector<Transform> X;
  for (const Pose& pose : motion.frames) {
    chain_kinematics(skeleton, chain.above, pose, X);
    out.push_back(limb_points(chain, X));
  }
  return out;
}

// The speed, m/s, that a limb's middle and end may have in the step from each frame to the next.
using SpeedLimits = std::vector<std::array<double, 2>>;

SpeedLimits speed_limits(const std::vector<LimbPoints>& path, const Motion& motion) {
  const double fps = motion.fps;
  const std::size_t steps = path.size() - 1, around = std::size_t(std::lround(kAround * fps)) + 1;
  SpeedLimits out(steps);
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<double> speeds;
    for (std::size_t f = 0; f < steps; ++f) speeds.push_back(span_speed(path, f + 1, k, fps));
    const double top = std::max(kSlow, kFaster * *std::ranges::max_element(speeds));
    for (std::size_t f = 0; f < steps; ++f) {
      const auto begin = speeds.begin() + std::ptrdiff_t(f > around ? f - around : 0),
                 end = speeds.begin() + std::ptrdiff_t(std::min(steps, f + around + 1));
      const double here = *std::max_element(begin, end);
      // What is carried by the pelvis goes with its turn, also where a recording's pelvis leaps.
      const double carried =
          fps * path[f][k].norm() *
          motion.frames[f].rotations[0].angularDistance(motion.frames[f + 1].rotations[0]);
      out[f][k] =
          std::max(carried, std::min(top, std::max(kFasterHere * here, here + kByMoreHere)));
    }
  }
  return out;
}

// The largest share of what they may be that speeds reach.
double worst_speed(const std::vector<LimbPoints>& path, const SpeedLimits& limits, double fps) {
  double out = 0;
  for (std::size_t f = 0; f < limits.size(); ++f)
    for (std::size_t k = 0; k < 2; ++k)
      out = std::max(out, span_speed(path, f + 1, k, fps) / limits[f][k]);
  return out;
}

// One limb over the motion.
class LimbSteadier {
 public:
  LimbSteadier(const Skeleton& skeleton, const LimitTables& tables, const Chain& limb,
               const SpeedLimits& limits, Motion& motion)
      : skeleton_(skeleton), tables_(tables), limb_(limb), limits_(limits), motion_(motion) {
    fade_ = std::ceil(kFade * motion.fps) + 1;
    if (limb.leg == nullptr) return;
    for (const Pose& pose : motion.frames) planted_.push_back(foot_of(pose));
  }

  // Averages what was added to `base`, by angle, until nothing is too fast; planted feet stay.
  // Returns the number of frames changed. `path`: of the limb, brought up to date.
  int run(const std::vector<Angles>& base, std::vector<LimbPoints>& path) {
    width_.assign(motion_.frames.size(), 0.0);
    std::vector<bool> changed(width_.size(), false);
    std::vector<Angles> change;
    for (int round = 0; round < kRounds; ++round) {
      if (!widen(path, kNarrow * std::exp2(round))) break;
      for (std::size_t f = change.size(); f < base.size(); ++f)
        change.push_back(angles(motion_.frames[f], false) - base[f]);
      for (std::size_t f = 0; f < width_.size(); ++f)
        if (width_[f] > 0 || changed[f]) {
          set_angles(base[f] + mean(change, f), motion_.frames[f]);
          changed[f] = true;
        }
      if (limb_.leg != nullptr) put_back(changed);
      for (std::size_t f = 0; f < width_.size(); ++f) {
        if (!changed[f]) continue;
        chain_kinematics(skeleton_, limb_.above, motion_.frames[f], X_);
        path[f] = limb_points(limb_, X_);
      }
    }
    return int(std::ranges::count(changed, true));
  }

  // `limited`: brought within limits first.
  Angles angles(const Pose& pose, bool limited) const {
    Angles out(3 * Eigen::Index(limb_.joints.size()));
    for (std::size_t k = 0; k < limb_.joints.size(); ++k) {
      const std::size_t j = limb_.joints[k];
      const Quat& turn = pose.rotations[j];
      out.segment<3>(3 * Eigen::Index(k)) =
          joint_angles(skeleton_.joints[j], limited ? clamped(skeleton_.joints[j], turn) : turn);
    }
    return out;
  }

 private:
  Transform foot_of(const Pose& pose) {
    chain_kinematics(skeleton_, limb_.above, pose, X_);
    return X_[std::size_t(limb_.leg->joints[3])];
  }

  bool stands(std::size_t f) const { return limb_.standing[f].heel || limb_.standing[f].ball; }

  // Frames from `frame` to the nearest stance in a direction; fade_ if there is none so near.
  double to_stance(int frame, int way) const {
    int f = frame;
    while (std::abs(f - frame) < fade_)
      if (f += way; f < 0 || f >= int(planted_.size()))
        return fade_;
      else if (stands(std::size_t(f)))
        return std::abs(f - frame);
    return fade_;
  }

  // The planted foot at its place; the heel of a flat one as high as that of `averaged`, up to
  // kMostRise.
  Transform planted_with_rise(std::size_t f, const Transform& averaged) const {
    Transform out = planted_[f];
    if (!limb_.standing[f].ball || !limb_.standing[f].heel) return out;
    const LimbChain& leg = *limb_.leg;
    const Vec3 sole = (leg.point - leg.heel).normalized(), along = out.linear() * sole,
               ball = out * leg.point;
    const auto risen = [&](const Transform& X) {
      return -std::asin(std::clamp((X.linear() * sole).y(), -1.0, 1.0));
    };
    const double rise = std::max(0.0, std::min(kMostRise, risen(averaged)) - risen(out));
    out.linear() = Eigen::AngleAxisd(rise, Vec3::UnitY().cross(along).normalized()) * out.linear();
    out.translation() = ball - out.linear() * leg.point;
    return out;
  }

  // Brings a leg whose foot is planted back to its place. What brings the foot back at a stance's
  // edge fades out around it.
  void put_back(std::vector<bool>& changed) {
    const Side side = limb_.leg == tables_.limbs.data() ? Side::left : Side::right;
    const std::vector<bool> averaged = changed;
    std::vector<Transform> now;
    for (const Pose& pose : motion_.frames) now.push_back(foot_of(pose));
    for (std::size_t f = 0; f < now.size(); ++f) {
      Transform goal = now[f];
      bool moves = averaged[f] && stands(f);
      if (moves) goal = planted_with_rise(f, now[f]);
      const std::array<double, 2> away = {to_stance(int(f), -1), to_stance(int(f), 1)};
      for (std::size_t k = 0; k < 2 && !stands(f); ++k) {
        const std::size_t edge = k == 0 ? f - std::size_t(away[k]) : f + std::size_t(away[k]);
        if (away[k] >= fade_ || !averaged[edge]) continue;
        const double share = 1 - smooth_step(away[k] / std::min(fade_, 0.5 * (away[0] + away[1])));
        const Mat3 turn = planted_[edge].linear() * now[edge].linear().transpose();
        goal.linear() =
            Quat::Identity().slerp(share, Quat(turn)).toRotationMatrix() * goal.linear();
        goal.translation() += share * (planted_[edge].translation() - now[edge].translation());
        moves |= share > 0;
      }
      if (!moves) continue;
      stand_with_leg(skeleton_, tables_, side, kStanding, limb_.standing[f], goal,
                     motion_.frames[f], workspace_);
      changed[f] = true;
    }
  }

  // Widens the mean around steps that are too fast: by `width`, s, and less on either side. Whether
  // there are any.
  bool widen(const std::vector<LimbPoints>& path, double width) {
    bool any = false;
    const int reach = int(std::ceil(2 * width * motion_.fps)), last = int(width_.size()) - 1;
    for (int step = 0; step < last; ++step) {
      const auto fast = [&](std::size_t k) {
        return span_speed(path, std::size_t(step) + 1, k, motion_.fps) >
               limits_[std::size_t(step)][k] * (1 + 1e-9);
      };
      if (!fast(0) && !fast(1)) continue;
      any = true;
      for (int f = std::max(0, step + 1 - reach); f <= std::min(last, step + reach); ++f) {
        const double away = std::abs(f - step - 0.5) / motion_.fps;
        double& here = width_[std::size_t(f)];
        here = std::max(here, width * std::min(1.0, 2 - away / width));
      }
    }
    return any;
  }

  // Mean of the values within a frame's width.
  Angles mean(const std::vector<Angles>& values, std::size_t frame) const {
    const double width = width_[frame] * motion_.fps;
    const int last = int(values.size()) - 1, f = int(frame);
    return raised_cosine_mean(
        width, Angles(Angles::Zero(values.front().size())),
        [&](int k) -> const Angles& { return values[std::size_t(std::clamp(f + k, 0, last))]; });
  }

  void set_angles(const Angles& wanted, Pose& pose) const {
    for (std::size_t k = 0; k < limb_.joints.size(); ++k) {
      const std::size_t j = limb_.joints[k];
      const Joint& joint = skeleton_.joints[j];
      pose.rotations[j] =
          joint_rotation(
              joint, wanted.segment<3>(3 * Eigen::Index(k)).cwiseMax(joint.min).cwiseMin(joint.max))
              .normalized();
    }
    complete_pose(skeleton_, pose);
  }

  const Skeleton& skeleton_;
  const LimitTables& tables_;
  const Chain& limb_;
  const SpeedLimits& limits_;
  Motion& motion_;
  double fade_ = 0;                 // frames
  std::vector<Transform> planted_;  // a leg's foot as it was, a frame
  LimitWorkspace workspace_;
  std::vector<double> width_;  // s, half of each frame's mean; 0: it stays
  std::vector<Transform> X_;
};

}  // namespace

int steady_limbs(const Skeleton& skeleton, const LimitTables& tables, const Motion& source,
                 const Motion& given, const std::vector<Contact>& contacts, Motion& motion) {
  const std::size_t frames = motion.frames.size();
  if (frames < 3) return 0;
  int changed = 0;
  for (const Chain& chain : chains_of(skeleton, tables, contacts, frames)) {
    const SpeedLimits limits = speed_limits(limb_path(skeleton, chain, source), source);
    std::vector<LimbPoints> path = limb_path(skeleton, chain, motion);
    double worst = worst_speed(path, limits, motion.fps);
    if (worst <= 1) continue;
    LimbSteadier limb(skeleton, tables, chain, limits, motion);
    std::vector<Angles> base;
    for (const Pose& pose : given.frames) base.push_back(limb.angles(pose, true));
    int most = 0;
    for (int pass = 0; pass < 2; ++pass) {
      const std::vector<Pose> before = motion.frames;
      const std::vector<LimbPoints> path_before = path;
      const int moved = limb.run(base, path);
      if (const double now = worst_speed(path, limits, motion.fps); now < worst) {
        worst = now;
        most = std::max(most, moved);
      } else {
        // A planted foot that a mean bends the leg for may leave it no way but a snap.
        motion.frames = before;
        path = path_before;
      }
      // Where the given motion itself leaps at its limits, the angles are averaged as they are.
      for (Angles& one : base) one.setZero();
    }
    changed += most;
  }
  return changed;
}

}  // namespace ecorche::inline v1
