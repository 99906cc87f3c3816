#include "skinning/constraints/joint_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "anatomy/chain_kinematics.h"
#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/smooth_step.h"
#include "anatomy/joint_angles.h"
#include "anatomy/joint_turn.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {
constexpr int kMost = 12;  // angles of a limb's four joints

// Scales of the least-squares terms: a residual of this size costs 1. A smaller scale is a stiffer
// term.
constexpr double kStray = 10 * kDegree;  // an angle's distance from the given pose
// the same for the axial rotations of knee and subtalar joint: a heel rises before a leg twists
constexpr double kTwist = 6 * kDegree;
constexpr double kMiddle = 5e-3;       // m; position of knee or elbow
constexpr double kNear = 3 * kDegree;  // an angle inside the margin at the end of its range
constexpr double kStands = 0.1e-3;     // m; position of a standing point
// m; position of the ball of a foot whose heel stands alone, height of a heel whose ball stands
constexpr double kRises = 5e-3;
constexpr double kTurns = 4 * kDegree;  // rotation of a standing foot
// Rotation, and way from its position, beyond which a hand or a free foot gives way.
constexpr double kYields = 8 * kDegree, kStrays = 10e-3;
constexpr double kSinks = 0.2e-3;  // m; heel, ball or toes below the ground
// The other parameters.
constexpr double kLast = 5 * kDegree;  // width of the margin, or a tenth of the range
constexpr double kRisen = 4e-3;        // m; a heel so high is held sideways half as stiffly
// an angle with a smaller range is not solved for and stays as at rest
constexpr double kHinge = 10 * kDegree;

using Angles = Eigen::Matrix<double, kMost, 1>;

// One limb in one frame.
class LimbSolver {
 public:
  LimbSolver(const Skeleton& skeleton, const std::vector<Mat3>& zeros, const LimbChain& chain,
             const Transform& base, const Transform& wanted, const Vec3& middle,
             const LimbTolerance& tolerance, const FootStand& stand, const Pose& start)
      : skeleton_(skeleton),
        chain_(chain),
        base_(base),
        wanted_(wanted),
        middle_(middle),
        tolerance_(tolerance),
        stand_(stand) {
    for (int k = 0; k < 4; ++k) {
      const Joint& joint = skeleton.joints[chain.joints[k]];
      const Mat3& zero = zeros[std::size_t(chain.joints[k])];
      const Vec3 angles = joint_angles(joint, start.rotations[chain.joints[k]], zero);
      from_zero_[k] = zero.transpose();
      for (int a = 0; a < 3; ++a) {
        const int i = 3 * k + a;
        const double room = joint.max[a] - joint.min[a], ease = std::min(kLast, room / 10);
        low_[i] = joint.min[a], high_[i] = joint.max[a], ease_[i] = ease;
        stray_[i] = chain.leg && k > 0 && a == 2 ? kTwist : kStray;
        const bool free = room >= kHinge;
        if (free) free_[count_++] = i;
        const bool rests = chain.leg && k == 1 && !free;  // the knee's own valgus
        x_[i] = rests ? joint.zero[a] : std::clamp(angles[a], low_[i], high_[i]);
      }
    }
    start_ = x_;
  }

  // Searches from these rotations of the joints on, in place of the angles that it stays near.
  void begin_from(const std::array<Quat, 4>& rotations, const std::vector<Mat3>& zeros) {
    for (int k = 0; k < 4; ++k) {
      const Vec3 angles =
          joint_angles(joint(k), rotations[std::size_t(k)], zeros[std::size_t(joint_at(k))]);
      for (int a = 0; a < 3; ++a) begin_at(3 * k + a, angles[a]);
    }
  }

  void solve(Pose& pose) {
    constexpr int kSteps = 40;
    Posed here = posed(x_);
    double damping = 1e-3, now = cost(x_, here);
    for (int step = 0; step < kSteps && now > 1e-12; ++step) {
      linearize(here);
      bool better = false, done = false;
      while (!better && damping < 1e9) {
        const Angles next = (x_ + descent(damping)).cwiseMax(low_).cwiseMin(high_);
        const Posed there = posed(next);
        const double then = cost(next, there);
        better = then < now;
        damping = std::max(1e-9, better ? damping * 0.2 : damping * 5);
        if (!better) continue;
        done = now - then < 1e-9 * now;
        x_ = next, now = then, here = there;
      }
      if (!better || done) break;
    }
    for (int k = 0; k < 4; ++k) {
      const Joint& turned = joint(k);
      pose.rotations[joint_at(k)] =
          Quat(Mat3(turned.axes * joint_turn(turned, x_.segment<3>(3 * k)) * from_zero_[k]))
              .normalized();
    }
  }

 private:
  // Of the latter: also of what is off the ground. Both are filled up to whole vector registers.
  static constexpr int kRows = 24, kAlways = 16;
  using Residual = Eigen::Matrix<double, kRows, 1>;
  using Jacobian = Eigen::Matrix<double, kRows, kMost>;

  void begin_at(int i, double angle) {
    if (high_[i] - low_[i] >= kHinge) x_[i] = std::clamp(angle, low_[i], high_[i]);
  }

  int joint_at(int k) const { return chain_.joints[k]; }
  const Joint& joint(int k) const { return skeleton_.joints[joint_at(k)]; }

  // The limb at angles x, and how it goes on as each of them grows: the axis in the world and the
  // joint on it.
  struct Posed {
    Transform end;
    std::array<Vec3, 4> at;
    Eigen::Matrix<double, 3, kMost> axes;
  };
  Posed posed(const Angles& x) const {
    Posed out;
    Transform& X = out.end = base_;
    for (int k = 0; k < 4; ++k) {
      X.translate(joint(k).X_PJ.translation());
      out.at[k] = X.translation();
      const TurnWithRates turn = joint_turn_with_rates(joint(k), x.segment<3>(3 * k));
      const Mat3 axes = X.linear() * joint(k).axes;
      out.axes.middleCols<3>(3 * k) = axes * turn.rates;
      X.linear() = axes * turn.turn * from_zero_[k];
    }
    return out;
  }

  // Movement of a point, from the end of the limb or of the k-th joint, a radian of angle i.
  static Vec3 moves(const Posed& limb, const Vec3& point, int i) {
    return limb.axes.col(i).cross(point - limb.at[i / 3]);
  }

  // Scaled residuals. Rows 0-2: the end's point; 3-11: its axes; 12-14: knee or elbow; 15-17: heel
  // and ball of a standing foot; 18-20: depth of heel, ball and toes below the ground. `J`: their
  // derivatives, if wanted.
  Residual residuals(const Posed& limb, Jacobian* J) const {
    Residual out = Residual::Zero();
    if (J != nullptr) J->setZero();
    const Transform& X = limb.end;
    // Rows from `row` on: a point's way from its place, each direction by its scale.
    const auto place = [&](int row, const Vec3& point, const Vec3& wanted, const Vec3& scale,
                           int angles) {
      out.segment<3>(row) = (point - wanted).cwiseProduct(scale);
      if (J == nullptr) return;
      for (int k = 0; k < count_ && free_[k] < angles; ++k)
        J->block<3, 1>(row, k) = moves(limb, point, free_[k]).cwiseProduct(scale);
    };
    place(12, limb.at[1], middle_, Vec3::Constant(1 / kMiddle), 3);
    const bool on_ground = chain_.leg && tolerance_.on_ground;
    const bool stands = on_ground && (stand_.ball || stand_.heel);
    turn(limb, stands ? kTurns : tolerance_.rotation, out, J);
    const Vec3 ball = X * chain_.point, ball_wanted = wanted_ * chain_.point;
    if (!on_ground) {
      place(0, ball, ball_wanted, Vec3::Constant(1 / tolerance_.position), kMost);
      give_way<3>(0, kStrays / tolerance_.position, out, J);
      return out;
    }
    const Vec3 heel = X * chain_.heel, heel_wanted = wanted_ * chain_.heel;
    if (stand_.ball) {
      place(0, ball, ball_wanted, Vec3::Constant(1 / kStands), kMost);
    } else if (stand_.heel) {
      // The ball yields before the heel, but a lack of ankle flexion must not turn the toes out:
      // the heel rises instead.
      place(0, heel, heel_wanted, Vec3(1 / kStands, 1 / kRises, 1 / kStands), kMost);
      place(15, ball, ball_wanted, Vec3::Constant(1 / kRises), kMost);
    } else {
      place(0, ball, ball_wanted, Vec3::Constant(1 / tolerance_.position), kMost);
      give_way<3>(0, kStrays / tolerance_.position, out, J);
    }
    if (stand_.ball && stand_.heel) {
      // The heel may rise where the ankle bends no further. It rotates about the ball, and is held
      // sideways less stiffly the higher it is.
      const Vec3 across = Vec3::UnitY().cross(ball_wanted - heel_wanted).normalized();
      const double high = std::max(0.0, heel.y() - heel_wanted.y()) / kRisen;
      const double hold = 1 / (kStands * (1 + high * high)), off = (heel - heel_wanted).dot(across);
      out[15] = hold * off;
      out[16] = (heel.y() - heel_wanted.y()) / kRises;
      for (int k = 0; J != nullptr && k < count_; ++k) {
        const Vec3 way = moves(limb, heel, free_[k]);
        (*J)(15, k) = hold * way.dot(across) -
                      2 * kStands * hold * hold * off * high * (high > 0 ? way.y() / kRisen : 0);
        (*J)(16, k) = way.y() / kRises;
      }
    }
    const std::array<Vec3, 3> soles = {heel, ball, X * chain_.toes_up};
    for (int p = 0; p < 3; ++p) {
      if (soles[p].y() >= 0) continue;
      out[18 + p] = soles[p].y() / kSinks;
      for (int k = 0; J != nullptr && k < count_; ++k)
        (*J)(18 + p, k) = moves(limb, soles[p], free_[k]).y() / kSinks;
    }
    return out;
  }

  // Rows 3-11: the end's rotation.
  void turn(const Posed& limb, double tolerance, Residual& out, Jacobian* J) const {
    const double scale = 1 / (std::numbers::sqrt2 * tolerance);
    const Mat3& R = limb.end.linear();
    for (int a = 0; a < 3; ++a)
      out.segment<3>(3 + 3 * a) = scale * (R.col(a) - wanted_.linear().col(a));
    for (int k = 0; J != nullptr && k < count_; ++k)
      for (int a = 0; a < 3; ++a)
        J->block<3, 1>(3 + 3 * a, k) = scale * limb.axes.col(free_[k]).cross(R.col(a));
    give_way<9>(3, kYields / tolerance, out, J);
  }

  // Beyond `most` the cost of these rows grows linearly only: a limb whose joints bend no further
  // keeps its knee or elbow in place and lets the foot or hand move, where a square would spread
  // the lack over all joints, one way or another by chance.
  template <int count>
  static void give_way(int row, double most, Residual& out, Jacobian* J) {
    const Eigen::Matrix<double, count, 1> off = out.segment<count>(row);
    const double size = off.norm();
    if (size <= most) return;
    const double root = std::sqrt(2 * most * size - most * most), share = root / size;
    out.segment<count>(row) = share * off;
    if (J == nullptr) return;
    // The share shrinks as the residual grows.
    const double slope = (most / root - share) / (size * size);
    const Eigen::Matrix<double, 1, kMost> along = off.transpose() * J->middleRows<count>(row);
    J->middleRows<count>(row) = share * J->middleRows<count>(row) + slope * off * along;
  }

  double beyond(double x, int i) const {
    return std::max(0.0, x - (high_[i] - ease_[i])) - std::max(0.0, low_[i] + ease_[i] - x);
  }

  double cost(const Angles& x, const Posed& limb) const {
    double sum = residuals(limb, nullptr).squaredNorm();
    for (int k = 0; k < count_; ++k) {
      const int i = free_[k];
      const double away = (x[i] - start_[i]) / stray_[i], near = beyond(x[i], i) / kNear;
      sum += away * away + near * near;
    }
    return sum;
  }

  // Of the free angles, one after another.
  void linearize(const Posed& limb) {
    Jacobian J;
    const Residual here = residuals(limb, &J);
    // Eigen's blocked product costs more than it saves at this size.
    if (chain_.leg && tolerance_.on_ground)
      set_normal_equations<kRows>(J, here);
    else
      set_normal_equations<kAlways>(J, here);
    for (int k = 0; k < count_; ++k) {
      const int i = free_[k];
      const double off = beyond(x_[i], i);
      hessian_(k, k) += 1 / (stray_[i] * stray_[i]) + (off != 0 ? 1 / (kNear * kNear) : 0);
      slope_[k] += (x_[i] - start_[i]) / (stray_[i] * stray_[i]) + off / (kNear * kNear);
    }
  }

  template <int kCount>
  void set_normal_equations(const Jacobian& J, const Residual& here) {
    for (int i = 0; i < count_; ++i) {
      const auto column = J.col(i).template head<kCount>();
      for (int j = 0; j <= i; ++j) hessian_(i, j) = column.dot(J.col(j).template head<kCount>());
      slope_[i] = column.dot(here.template head<kCount>());
    }
  }

  // A damped Newton step. Angles at a limit that the gradient pushes outwards are held (active
  // set).
  Angles descent(double damping) const {
    std::array<int, kMost> moved{};
    int count = 0;
    for (int k = 0; k < count_; ++k) {
      const int i = free_[k];
      const bool held = (x_[i] >= high_[i] && slope_[k] < 0) || (x_[i] <= low_[i] && slope_[k] > 0);
      if (!held) moved[count++] = k;
    }
    Eigen::Matrix<double, kMost, kMost> H;
    Angles g;
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b <= a; ++b) H(a, b) = hessian_(moved[a], moved[b]);
      H(a, a) += damping * (1 + H(a, a));
      g[a] = -slope_[moved[a]];
    }
    const Angles step = solve_llt_first<kMost>(count, H, g);
    Angles out = Angles::Zero();
    for (int a = 0; a < count; ++a) out[free_[moved[a]]] = step[a];
    return out;
  }

  const Skeleton& skeleton_;
  const LimbChain& chain_;
  const Transform base_, wanted_;
  const Vec3 middle_;
  const LimbTolerance tolerance_;
  const FootStand stand_;
  std::array<int, kMost> free_{};  // angles that are solved for
  int count_ = 0;
  std::array<Mat3, 4> from_zero_;  // of each joint: out of its axes at the anatomical zero
  Angles x_, start_, low_, high_, ease_, stray_;
  Eigen::Matrix<double, kMost, kMost> hessian_;  // lower half; of the free angles, as slope_
  Angles slope_;
};

// Counter-rotation of the toes of a foot that the limits have rotated by `turn`: all of it for
// small angles, so that the toes keep their world rotation, and none for large ones.
Quat toe_help(const Mat3& turn) {
  constexpr double kNearby = 20 * kDegree, kAway = 60 * kDegree;
  const Quat whole(turn);
  return whole.slerp(smooth_step(kNearby, kAway, whole.angularDistance(Quat::Identity())),
                     Quat::Identity());
}

// Extends toes whose tip is below the ground, within their limits.
void raise_toes(const Skeleton& skeleton, const FootShape& foot, Pose& pose,
                std::vector<Transform>& X) {
  constexpr double kEnough = 1e-4;  // m
  double low = -HUGE_VAL;
  for (int round = 0; round < 4; ++round) {
    const FootPoints at = foot_points(skeleton, foot, X);
    if (at.tip.y() > -kEnough || at.tip.y() < low + kEnough) return;
    low = at.tip.y();
    const Vec3 lever = at.tip - X[foot.mtp[1]].translation();
    const double angle = -at.tip.y() / std::max(0.02, std::hypot(lever.x(), lever.z()));
    const Mat3 up =
        Eigen::AngleAxisd(angle, lever.cross(Vec3::UnitY()).normalized()).toRotationMatrix();
    for (const int toe : foot.mtp) {
      const std::size_t mtp = toe;
      const Mat3 parent = X[foot.subtalar].linear();
      pose.rotations[mtp] = clamped(
          skeleton.joints[mtp], Quat(Mat3(parent.transpose() * up * X[mtp].linear())).normalized());
      X[mtp].linear() = parent * pose.rotations[mtp].toRotationMatrix();
    }
  }
}

// One limb of a pose whose trunk is inside its limits, with the toes of a leg. `given`: the pose
// before; where it is another object, `pose` is a first guess. workspace.after is brought up to
// date.
void limit_limb(const Skeleton& skeleton, const LimitTables& tables, const LimbTolerance& tolerance,
                const std::array<FootStand, 2>& stands, const LimbShifts& shifts, std::size_t l,
                const Pose& given, Pose& pose, LimitWorkspace& workspace) {
  const std::vector<Transform>& was = workspace.before;
  std::vector<Transform>& is = workspace.after;
  const LimbChain& limb = tables.limbs[l];
  const std::size_t first = std::size_t(limb.joints[0]), end = std::size_t(limb.joints[3]),
                    parent = std::size_t(skeleton.joints[first].parent),
                    thorax = std::size_t(tables.thorax);
  const Transform carried = limb.leg ? Transform::Identity() : is[thorax] * was[thorax].inverse();
  std::array<Quat, 4> last;
  for (std::size_t k = 0; k < 4; ++k) last[k] = pose.rotations[std::size_t(limb.joints[k])];
  pose.rotations[first] =
      clamped(skeleton.joints[first],
              Quat(Mat3(is[parent].linear().transpose() * carried.linear() * was[first].linear()))
                  .normalized(),
              tables.zeros[first]);
  for (std::size_t k = 1; k < 4; ++k) {
    const std::size_t j = std::size_t(limb.joints[k]);
    pose.rotations[j] = clamped(skeleton.joints[j], given.rotations[j], tables.zeros[j]);
  }
  const Vec3 middle = carried * was[std::size_t(limb.joints[1])].translation() + shifts[l].middle;
  Transform wanted = carried * was[end];
  wanted.pretranslate(shifts[l].end);
  LimbSolver solver(skeleton, tables.zeros, limb, is[parent], wanted, middle, tolerance,
                    limb.leg ? stands[l] : FootStand{}, pose);
  if (&given != &pose) solver.begin_from(last, tables.zeros);
  solver.solve(pose);
  for (const int j : limb.joints)
    is[std::size_t(j)] = joint_frame(skeleton, pose, is, std::size_t(j));
  if (!limb.leg) return;
  const FootShape& foot = tables.feet[l];
  const Quat help = toe_help(is[end].linear().transpose() * was[end].linear());
  for (const int toe : foot.mtp) {
    const std::size_t j = std::size_t(toe);
    pose.rotations[j] =
        clamped(skeleton.joints[j], (help * given.rotations[j]).normalized(), tables.zeros[j]);
    is[j] = joint_frame(skeleton, pose, is, j);
  }
  if (tolerance.on_ground) raise_toes(skeleton, foot, pose, is);
}

}  // namespace

LimitTables make_limit_tables(const Skeleton& skeleton, double sole_height) {
  LimitTables tables;
  const std::vector<Vec3> rest = rest_positions(skeleton);
  tables.thorax = joint_of(skeleton, "thorax");
  for (const Joint& joint : skeleton.joints) tables.zeros.push_back(joint_zero(joint));
  tables.kept.assign(skeleton.joints.size(), 0);
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    const std::string& name = skeleton.joints[j].name;
    const bool trunk = name.find('_') == std::string::npos && name != "jaw";
    if (trunk || name.starts_with("clavicle") || name.starts_with("scapula")) tables.kept[j] = 1;
    if (name.starts_with("mtp")) tables.kept[j] = 3;
  }
  for (int side = 0; side < 2; ++side) {
    const std::string s = side_suffix(side == 0 ? Side::left : Side::right);
    const FootShape foot = foot_shape(skeleton, side == 0 ? Side::left : Side::right, sole_height);
    LimbChain& leg = tables.limbs[side];
    const Vec3 subtalar = rest[foot.subtalar];
    leg = {{foot.hip, foot.knee, foot.ankle, foot.subtalar},
           foot.ball - subtalar,
           foot.heel - subtalar,
           foot.toes_up - subtalar,
           true,
           {}};
    tables.feet[side] = foot;
    LimbChain& arm = tables.limbs[2 + side];
    arm.joints = {joint_of(skeleton, "shoulder" + s), joint_of(skeleton, "elbow" + s),
                  joint_of(skeleton, "forearm" + s), joint_of(skeleton, "wrist" + s)};
    for (LimbChain* limb : {&leg, &arm}) {
      std::vector<int> ends(limb->joints.begin(), limb->joints.end());
      if (limb->leg)
        ends.insert(ends.end(), foot.mtp.begin(), foot.mtp.end());
      else
        ends.push_back(tables.thorax);
      limb->above = joints_up_from(skeleton, ends);
      for (const int j : limb->joints) tables.kept[j] = 2;
    }
  }
  std::vector<int> moved;
  for (std::size_t j = 0; j < tables.kept.size(); ++j)
    if (tables.kept[j] != 0) moved.push_back(int(j));
  tables.needed = joints_up_from(skeleton, moved);
  return tables;
}

void enforce_limits(const Skeleton& skeleton, const LimitTables& tables,
                    const LimbTolerance& tolerance, const std::array<FootStand, 2>& stands,
                    const LimbShifts& shifts, Pose& pose, LimitWorkspace& workspace) {
  chain_kinematics(skeleton, tables.needed, pose, workspace.before);
  const std::vector<Transform>& was = workspace.before;
  std::vector<Transform>& is = workspace.after;
  is = was;
  workspace.clamped.resize(skeleton.joints.size());
  for (std::size_t j = 1; j < skeleton.joints.size(); ++j) {
    const char kept = tables.kept[j];
    if (kept > 1) continue;
    const Joint& joint = skeleton.joints[j];
    if (kept == 1) {
      const std::size_t parent = std::size_t(joint.parent);
      pose.rotations[j] =
          clamped(joint, Quat(Mat3(is[parent].linear().transpose() * was[j].linear())).normalized(),
                  tables.zeros[j]);
    } else {
      // Fingers stay as they are for long.
      LimitWorkspace::Clamped& last = workspace.clamped[j];
      if (pose.rotations[j].coeffs() != last.given.coeffs())
        last = {pose.rotations[j], clamped(joint, pose.rotations[j], tables.zeros[j])};
      pose.rotations[j] = last.inside;
    }
    if (std::ranges::binary_search(tables.needed, int(j)))
      is[j] = joint_frame(skeleton, pose, is, j);
  }
  for (std::size_t l = 0; l < tables.limbs.size(); ++l)
    limit_limb(skeleton, tables, tolerance, stands, shifts, l, pose, pose, workspace);
  complete_pose(skeleton, pose);
}

void renew_limbs(const Skeleton& skeleton, const LimitTables& tables,
                 const LimbTolerance& tolerance, const std::array<FootStand, 2>& stands,
                 const LimbShifts& shifts, const std::array<bool, 4>& which, const Pose& given,
                 Pose& pose, LimitWorkspace& workspace) {
  for (std::size_t l = 0; l < tables.limbs.size(); ++l) {
    if (!which[l]) continue;
    chain_kinematics(skeleton, tables.limbs[l].above, given, workspace.before);
    chain_kinematics(skeleton, tables.limbs[l].above, pose, workspace.after);
    limit_limb(skeleton, tables, tolerance, stands, shifts, l, given, pose, workspace);
  }
  complete_pose(skeleton, pose);
}

void stand_with_leg(const Skeleton& skeleton, const LimitTables& tables, Side side,
                    const LimbTolerance& tolerance, const FootStand& stand, const Transform& foot,
                    Pose& pose, LimitWorkspace& workspace) {
  const std::size_t s = side == Side::left ? 0 : 1;
  const LimbChain& leg = tables.limbs[s];
  const std::size_t pelvis = skeleton.joints[leg.joints[0]].parent;
  std::vector<Transform>& X = workspace.before;
  chain_kinematics(skeleton, tables.needed, pose, X);
  LimbSolver(skeleton, tables.zeros, leg, X[pelvis], foot, X[leg.joints[1]].translation(),
             tolerance, stand, pose)
      .solve(pose);
  chain_kinematics(skeleton, tables.needed, pose, X);
  if (tolerance.on_ground) raise_toes(skeleton, tables.feet[s], pose, X);
  complete_pose(skeleton, pose);
}

}  // namespace ecorche::inline v1
