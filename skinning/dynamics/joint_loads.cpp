#include "skinning/dynamics/joint_loads.h"

namespace ecorche::inline v1 {
namespace {

// How the frame of a joint moves, world.
struct FrameMotion {
  Vec3 velocity, acceleration, rate, turning;
};

std::vector<FrameMotion> frame_motions(const Skeleton& skeleton, const MotionState& state,
                                       const std::vector<Transform>& X) {
  std::vector<FrameMotion> out;
  for (std::size_t j = 0; j < X.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent < 0) {
      out.push_back({state.root_velocity, state.root_acceleration, state.rates[j],
                     state.turn_accelerations[j]});
      continue;
    }
    const FrameMotion& p = out[parent];
    const Mat3 R = X[parent].linear();
    const Vec3 arm = X[j].translation() - X[parent].translation(), turn = R * state.rates[j];
    out.push_back({p.velocity + p.rate.cross(arm),
                   p.acceleration + p.turning.cross(arm) + p.rate.cross(p.rate.cross(arm)),
                   p.rate + turn,
                   p.turning + R * state.turn_accelerations[j] + p.rate.cross(turn)});
  }
  return out;
}

}  // namespace

void find_joint_loads(const Skeleton& skeleton, std::span<const BodySegment> segments,
                      const MotionState& state, std::span<const ExternalForce> forces,
                      BodyLoads& out) {
  forward_kinematics(skeleton, state.pose, out.X_WJ);
  const std::vector<Transform>& X = out.X_WJ;
  const std::vector<FrameMotion> motions = frame_motions(skeleton, state, X);
  out.joints.assign(X.size(), {});
  out.power.assign(X.size(), 0);
  out.momentum = {};
  BodyMomentum& whole = out.momentum;
  const auto add = [&](int joint, const Vec3& place, const Vec3& force, const Vec3& moment) {
    out.joints[joint].force += force;
    out.joints[joint].moment += moment + (place - X[joint].translation()).cross(force);
  };
  Vec3 about_origin = Vec3::Zero();
  for (const BodySegment& segment : segments) {
    const Transform& frame = X[segment.joint];
    const FrameMotion& m = motions[segment.joint];
    const Vec3 arm = frame.linear() * segment.center, place = frame.translation() + arm;
    const Mat3 inertia = frame.linear() * segment.inertia * frame.linear().transpose();
    const Vec3 velocity = m.velocity + m.rate.cross(arm), spin = inertia * m.rate;
    Vec3 acceleration = m.acceleration + m.turning.cross(arm) + m.rate.cross(m.rate.cross(arm));
    acceleration.y() += kGravity;
    add(segment.joint, place, segment.mass * acceleration,
        inertia * m.turning + m.rate.cross(spin));
    whole.mass += segment.mass;
    whole.center += segment.mass * place;
    whole.velocity += segment.mass * velocity;
    whole.kinetic_energy += 0.5 * segment.mass * velocity.squaredNorm() + 0.5 * m.rate.dot(spin);
    about_origin += spin + segment.mass * place.cross(velocity);
  }
  if (whole.mass > 0) {
    whole.center /= whole.mass;
    whole.velocity /= whole.mass;
  }
  whole.angular = about_origin - whole.mass * whole.center.cross(whole.velocity);
  for (const ExternalForce& f : forces) add(f.joint, f.place, -f.force, -f.moment);
  for (std::size_t j = X.size(); j-- > 1;) {
    const int parent = skeleton.joints[j].parent;
    const JointLoad load = out.joints[j];
    add(parent, X[j].translation(), load.force, load.moment);
    out.power[j] = load.moment.dot(motions[j].rate - motions[parent].rate);
  }
}

}  // namespace ecorche::inline v1
