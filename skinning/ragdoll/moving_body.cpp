#include "skinning/ragdoll/moving_body.h"

#include <cmath>
#include <numbers>

#include "skinning/motion/sample_motion.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMotionStep = 1e-3;  // s, of the difference that gives velocities

Vec3 turn_between(const Quat& from, const Quat& to) {
  const Eigen::AngleAxisd turn((to * from.conjugate()).normalized());
  const double angle = std::remainder(turn.angle(), 2 * std::numbers::pi);
  return angle * turn.axis();
}

}  // namespace

BodyState moving_body(const ArticulatedModel& body, const Motion& motion, double time) {
  BodyState out;
  Pose before, after;
  pose_at(motion, time, out.pose);
  pose_at(motion, time - kMotionStep, before);
  pose_at(motion, time + kMotionStep, after);
  const double span = 2 * kMotionStep;
  out.velocity.setZero(body.freedoms());
  if (body.driven.empty()) {
    out.velocity.head<3>() = (after.root - before.root) / span;
    out.velocity.segment<3>(3) = turn_between(before.rotations[0], after.rotations[0]) / span;
  }
  int column = body.root_freedoms();
  for (const PassiveJoint& group : body.groups) {
    for (std::size_t k = 0; k < group.joints.size(); ++k) {
      const std::size_t j = std::size_t(group.joints[k]);
      const Vec3 turn = body.skeleton.joints[j].axes.transpose() *
                        turn_between(before.rotations[j], after.rotations[j]) / span;
      for (int a = 0; a < group.axes; ++a) out.velocity[column + a] += turn[group.first_axis + a];
    }
    column += group.axes;
  }
  return out;
}

JointMotion frame_motion(const Transform& before, const Transform& now, const Transform& after,
                         double step) {
  JointMotion out;
  out.origin = (now.translation() - before.translation()) / step;
  out.turn = turn_between(Quat(before.linear()), Quat(now.linear())) / step;
  const Vec3 next = (after.translation() - now.translation()) / step;
  out.origin_rate = (next - out.origin) / step;
  out.turn_rate = (turn_between(Quat(now.linear()), Quat(after.linear())) / step - out.turn) / step;
  return out;
}

}  // namespace ecorche::inline v1
