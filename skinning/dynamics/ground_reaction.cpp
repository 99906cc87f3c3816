#include "skinning/dynamics/ground_reaction.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/smooth_step.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kStandsBelow = 0.02, kLeavesAbove = 0.05;  // m over the floor
constexpr double kStandsSlower = 0.8, kLeavesFaster = 1.6;  // m/s
constexpr double kHeelWidth = 0.3;  // half, of the width between the outer balls
constexpr double kToeLength = 0.5;  // of the big toe beyond its joint, of what lies before that
// What a point's force costs over its gate: at a gate of this the point gives half of what is
// asked.
constexpr double kForceCost = 1e-4;
// Radius of the arc that is rolled over, of the shank's length: 0.22 of the stature (22 % in people
// of 12 to 17 years and "similar" in adults) over 0.246. Its centre before the ankle, m: so that
// one stands with the pressure 4 to 5 cm before it.
constexpr double kArcRadius = 0.9, kArcForwards = 0.02;
constexpr double kToesOfArc = 1.15;           // from the heel, of the way to the ball
constexpr double kStill = 0.3, kRolls = 0.8;  // m/s along the foot
// Cost of a distance from the arc over that of the same distance from where the moments want it:
// the latter swings three times as far, by 60 mm over 20.
constexpr double kArcCost = 9;
// Friction's moment about the vertical over the vertical force: 0.6 times the arm of a sole, m.
constexpr double kMostFreeMoment = 0.03;
constexpr double kPivotOverHips = 0.25, kLeastHeight = 0.5;  // m, of what feet push towards
constexpr double kMostLean = 0.2;    // horizontal over vertical force, that the arc may add
constexpr double kMostFriction = 1;  // horizontal over vertical force; beyond it soles slip

// min |A x - b|^2 + cost |x|^2 for x >= 0, by active sets (Lawson and Hanson 1974, chapter 23).
Eigen::VectorXd solve_pushing(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double cost) {
  const Eigen::Index n = A.cols();
  const Eigen::MatrixXd G = A.transpose() * A + cost * Eigen::MatrixXd::Identity(n, n);
  const Eigen::VectorXd h = A.transpose() * b;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> pushing;
  const auto solve = [&] {
    const Eigen::MatrixXd part = G(pushing, pushing);
    const Eigen::VectorXd right = h(pushing);
    return solve_ldlt(part, right);
  };
  for (Eigen::Index round = 0; round < 3 * n; ++round) {
    Eigen::VectorXd gain = h - G * x;
    for (const Eigen::Index i : pushing) gain[i] = 0;
    Eigen::Index next = 0;
    if (!(gain.maxCoeff(&next) > 1e-12)) break;
    pushing.push_back(next);
    for (;;) {
      const Eigen::VectorXd wanted = solve();
      double step = 1;
      for (std::size_t k = 0; k < pushing.size(); ++k)
        if (wanted[Eigen::Index(k)] <= 0)
          step = std::min(step, x[pushing[k]] / (x[pushing[k]] - wanted[Eigen::Index(k)]));
      for (std::size_t k = 0; k < pushing.size(); ++k)
        x[pushing[k]] += step * (wanted[Eigen::Index(k)] - x[pushing[k]]);
      if (step >= 1) break;
      std::erase_if(pushing, [&](Eigen::Index i) {
        if (x[i] > 1e-12) return false;
        x[i] = 0;
        return true;
      });
    }
  }
  return x;
}

}  // namespace

double contact_gate(double height, const Vec3& velocity) {
  const double leaving = std::max(0.0, velocity.y());
  const double speed = Vec3(velocity.x(), leaving, velocity.z()).norm();
  return (1 - smooth_step(kStandsBelow, kLeavesAbove, height)) *
         (1 - smooth_step(kStandsSlower, kLeavesFaster, speed));
}

std::vector<SolePoint> sole_points(const Skeleton& skeleton, double sole_height) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  std::vector<SolePoint> out;
  for (const Side side : {Side::left, Side::right}) {
    const FootShape foot = foot_shape(skeleton, side, sole_height);
    const auto at = [&](const char* name) {
      return rest[joint_of(skeleton, std::string(name) + side_suffix(side))];
    };
    const auto add = [&](int joint, Vec3 place) {
      place.y() = sole_height;
      out.push_back({side == Side::right, joint, place - rest[joint]});
    };
    const Vec3 across = at("mtp5") - at("mtp1");
    add(foot.subtalar, foot.heel);
    const Vec3 inside = foot.heel + 0.25 * (foot.ball - foot.heel);
    add(foot.subtalar, inside - kHeelWidth * across);
    add(foot.subtalar, inside + kHeelWidth * across);
    add(foot.subtalar, at("mtp1"));
    add(foot.subtalar, at("mtp3"));
    add(foot.subtalar, at("mtp5"));
    add(foot.mtp[0], at("toe_ip1") + kToeLength * (at("toe_ip1") - at("mtp1")));
    add(foot.mtp[2], at("toe_dip3"));
  }
  return out;
}

RollOver roll_over(const Vec3& knee, const Vec3& ankle, double ankle_height, const Vec3& heel,
                   const Vec3& ball, const Vec3& velocity) {
  RollOver out;
  const Vec3 along = ball - heel, up = (knee - ankle).normalized();
  const Vec3 level(along.x(), 0, along.z());
  if (!(level.norm() > 1e-3)) return out;
  out.heading = level.normalized();
  const Vec3 forwards = (out.heading - up * up.dot(out.heading)).normalized();
  const double radius = kArcRadius * (knee - ankle).norm();
  out.place = ankle + (radius - ankle_height) * up + kArcForwards * forwards;
  // No further than the sole reaches.
  const double at = (out.place - heel).dot(out.heading), length = level.norm();
  out.place += (std::clamp(at, 0.0, kToesOfArc * length) - at) * out.heading;
  out.share = smooth_step(kStill, kRolls, std::abs(velocity.dot(out.heading)));
  return out;
}

GroundReaction share_ground_reaction(const JointLoad& wanted, const Vec3& root, double weight,
                                     double floor, const std::vector<SolePoint>& points,
                                     const std::vector<SoleContact>& contacts,
                                     const std::array<RollOver, 2>& rolls) {
  GroundReaction out;
  std::array<Vec3, 2> middles{Vec3::Zero(), Vec3::Zero()};
  std::array<double, 2> counts{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    middles[points[i].foot] += contacts[i].place;
    ++counts[points[i].foot];
  }
  for (std::size_t f = 0; f < 2; ++f) {
    out.feet[f].place = middles[f] / std::max(1.0, counts[f]);
    out.feet[f].place.y() = floor;
  }
  if (!(wanted.force.y() > 0)) return out;
  // Moments about the point of the floor below the root, of which forces along the floor have none
  // about its own axes.
  const Vec3 below(root.x(), floor, root.z());
  const Vec3 moment = wanted.moment + (root - below).cross(wanted.force);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(5, Eigen::Index(points.size()));
  std::vector<double> scales;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 arm = contacts[i].place - below;
    scales.push_back(std::sqrt(contacts[i].gate));
    A.col(Eigen::Index(i)).head<3>() = scales.back() * Vec3(1, -arm.z(), arm.x());
    const RollOver& roll = rolls[points[i].foot];
    A(3 + points[i].foot, Eigen::Index(i)) = std::sqrt(kArcCost * roll.share) * scales.back() *
                                             (contacts[i].place - roll.place).dot(roll.heading);
  }
  Eigen::VectorXd asked = Eigen::VectorXd::Zero(5);
  asked.head<3>() = Vec3(wanted.force.y(), moment.x(), moment.z()) / weight;
  const Eigen::VectorXd found = solve_pushing(A, asked, kForceCost);
  std::vector<double> vertical;
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    vertical.push_back(weight * scales[i] * found[Eigen::Index(i)]);
    sum += vertical.back();
  }
  if (!(sum > 1e-9 * weight)) return out;
  std::array<double, 2> carried{};
  std::array<Vec3, 2> centers{Vec3::Zero(), Vec3::Zero()};
  for (std::size_t i = 0; i < points.size(); ++i) {
    carried[points[i].foot] += vertical[i];
    centers[points[i].foot] += vertical[i] * contacts[i].place;
  }
  for (std::size_t f = 0; f < 2; ++f)
    if (carried[f] > 0) centers[f] /= carried[f];
  // Along the floor: as much as is asked for of what the points carry.
  const double share = std::min(1.0, sum / wanted.force.y());
  Vec3 along = share * Vec3(wanted.force.x(), 0, wanted.force.z());
  // What the arc takes from the moments is given back by leaning the force, so that it passes the
  // body's middle where it did: where a foot is pushed is known no better than how steeply.
  double rolled = 0;
  for (std::size_t f = 0; f < 2; ++f) rolled += carried[f] / sum * rolls[f].share;
  Vec3 missing = rolled * moment;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 arm = contacts[i].place - below;
    missing -= rolled * vertical[i] * Vec3(-arm.z(), 0, arm.x());
  }
  const double middle = std::max(root.y() - floor, kLeastHeight), most = kMostLean * sum;
  const Vec3 lean = Vec3(missing.z(), 0, -missing.x()) / middle;
  along += lean * std::min(1.0, most / std::max(lean.norm(), 1e-9 * weight));
  along *= std::min(1.0, kMostFriction * sum / std::max(along.norm(), 1e-9 * weight));
  // Each foot pushes towards one point over the hips, and does its part of the rest.
  std::array<Vec3, 2> leaning{Vec3::Zero(), Vec3::Zero()};
  const double height = std::max(root.y() - floor + kPivotOverHips, kLeastHeight);
  for (std::size_t f = 0; f < 2; ++f) {
    leaning[f] = carried[f] / height * (below - centers[f]);
    leaning[f].y() = 0;
  }
  const Vec3 rest = along - leaning[0] - leaning[1];
  double turned = share * moment.y();
  for (std::size_t f = 0; f < 2; ++f) {
    leaning[f] += carried[f] / sum * rest;
    const Vec3 arm = centers[f] - below;
    turned -= arm.z() * leaning[f].x() - arm.x() * leaning[f].z();
  }
  const double free_moment = std::clamp(turned, -kMostFreeMoment * sum, kMostFreeMoment * sum);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(vertical[i] > 0)) continue;
    const double part = vertical[i] / sum;
    const Vec3 force =
        vertical[i] / carried[points[i].foot] * leaning[points[i].foot] + Vec3(0, vertical[i], 0);
    const Vec3 place(contacts[i].place.x(), floor, contacts[i].place.z());
    out.forces.push_back({points[i].joint, place, force, Vec3(0, part * free_moment, 0)});
    FootForce& foot = out.feet[points[i].foot];
    foot.force += force;
    foot.free_moment += part * free_moment;
  }
  for (std::size_t f = 0; f < 2; ++f)
    if (carried[f] > 0) out.feet[f].place = Vec3(centers[f].x(), floor, centers[f].z());
  return out;
}

}  // namespace ecorche::inline v1
