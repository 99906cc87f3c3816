#include "skinning/ragdoll/limp_motion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "anatomy/joints_below.h"
#include "skinning/motion/require_joint.h"
#include "skinning/motion/sample_motion.h"
#include "skinning/ragdoll/moving_body.h"

namespace ecorche::inline v1 {
namespace {

// Of a chain those joints that are limp, with their shares of what is left.
PassiveJoint limp_part(const PassiveJoint& group, const std::vector<char>& driven) {
  PassiveJoint out = group;
  out.joints.clear();
  out.shares.clear();
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < group.joints.size(); ++k) {
    if (driven[std::size_t(group.joints[k])]) continue;
    out.joints.push_back(group.joints[k]);
    out.shares.push_back(group.shares[k]);
    sum += group.shares[k];
  }
  for (Vec3& share : out.shares) share = share.cwiseQuotient(sum);
  return out;
}

void let_go(const std::vector<std::string>& limp, ArticulatedModel& body) {
  const Skeleton& skeleton = body.skeleton;
  body.driven.assign(skeleton.joints.size(), 1);
  for (const std::string& name : limp) {
    const int first = joint_of(skeleton, name);
    if (first == 0)
      throw std::invalid_argument(name + " carries all of the body, which would fall");
    const std::vector<char> below = joints_below(skeleton, first);
    bool swings = false;
    for (const PassiveJoint& group : body.groups)
      for (const int j : group.joints) swings |= below[std::size_t(j)] != 0;
    if (!swings) throw std::invalid_argument("nothing at and below " + name + " swings");
    for (std::size_t j = 0; j < below.size(); ++j)
      if (below[j]) body.driven[j] = 0;
  }
  std::vector<PassiveJoint> groups;
  for (const PassiveJoint& group : body.groups) {
    PassiveJoint part = limp_part(group, body.driven);
    if (!part.joints.empty()) groups.push_back(std::move(part));
  }
  body.groups = std::move(groups);
}

std::vector<char> swinging_joints(const ArticulatedModel& body) {
  std::vector<char> out(body.skeleton.joints.size(), 0);
  for (const PassiveJoint& group : body.groups)
    for (const int j : group.joints) out[std::size_t(j)] = 1;
  return out;
}

// All that does not swing is as the motion has it.
void follow(const Skeleton& skeleton, const Pose& moved, const std::vector<char>& swings,
            Pose& pose) {
  pose.root = moved.root;
  for (std::size_t j = 0; j < swings.size(); ++j)
    if (!swings[j]) pose.rotations[j] = moved.rotations[j];
  complete_pose(skeleton, pose);
}

}  // namespace

LimpResult limp_motion(Ragdoll ragdoll, const Motion& motion, const std::vector<std::string>& limp,
                       const RagdollOptions& given) {
  ArticulatedModel& body = ragdoll.body;
  let_go(limp, body);
  const Skeleton& skeleton = body.skeleton;
  const std::vector<char> swings = swinging_joints(body);
  LimpResult out;
  for (std::size_t j = 0; j < swings.size(); ++j)
    if (swings[j]) out.joints.push_back(skeleton.joints[j].name);
  RagdollOptions options = given;
  const int steps = std::max(1, int(std::ceil(1 / (motion.fps * given.step) - 1e-9)));
  const double h = options.step = 1 / (motion.fps * steps);
  RagdollState state;
  state.body = moving_body(body, motion, 0);
  state.rest = set_tone(0, state.body.pose, body);
  state.body.driven.resize(swings.size());
  std::vector<Transform> before, now, after;
  Pose moved;
  pose_at(motion, 0, moved);
  forward_kinematics(skeleton, moved, now);
  before = now;
  out.motion.fps = motion.fps;
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    Pose frame = state.body.pose;
    follow(skeleton, motion.frames[f], swings, frame);
    out.motion.frames.push_back(frame);
    forward_kinematics(skeleton, frame, state.frames.X_WJ);
    out.limit_excess = std::max(out.limit_excess, worst_limit_excess(body, frame));
    for (const double depth : penetration_depths(ragdoll.limbs, state.frames.X_WJ))
      out.overlap = std::max(out.overlap, depth);
    for (int s = 0; s < steps; ++s) {
      pose_at(motion, (double(f) + double(s) / steps) / motion.fps, moved);
      follow(skeleton, moved, swings, state.body.pose);
      pose_at(motion, (double(f) + double(s + 1) / steps) / motion.fps, moved);
      forward_kinematics(skeleton, moved, after);
      for (std::size_t j = 0; j < swings.size(); ++j)
        if (body.driven[j]) state.body.driven[j] = frame_motion(before[j], now[j], after[j], h);
      step_ragdoll(ragdoll, options, state);
      std::swap(before, now);
      std::swap(now, after);
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
