// Courses of a character's ragdoll, for compare_falls.py: ragdoll_figures CHARACTER.glb FOLDER
// [STEPS A SECOND]
//
// Each case has no resistance in its joints and begins with joints at rest. FOLDER/NAME_start.csv:
// what moves, `joint,axis x,y,z,velocity` a freedom, the root's first with `root` and `turn` as
// joints; NAME_course.csv: time, kinetic and potential energy, and places of joints.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "app/files/actor.h"
#include "app/ragdoll/character_ragdoll.h"
#include "skinning/files/character_read.h"
#include "skinning/motion/require_joint.h"
#include "skinning/ragdoll/fall.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

const std::vector<std::string> kSeen = {"pelvis",  "head",   "elbow_l", "wrist_l", "elbow_r",
                                        "wrist_r", "knee_l", "ankle_l", "knee_r",  "ankle_r"};

void write_start(const std::string& file, const ArticulatedModel& body, const BodyState& state) {
  std::ofstream out(file);
  const auto row = [&](const std::string& joint, const Vec3& axis, double velocity) {
    out << fmt::format("{},{},{},{},{}\n", joint, axis.x(), axis.y(), axis.z(), velocity);
  };
  row("place", state.pose.root, 0);
  const Quat& turned = state.pose.rotations[0];
  row("turned", turned.vec(), turned.w());
  for (int k = 0; k < body.root_freedoms(); ++k)
    row(k < 3 ? "root" : "turn", Vec3::Unit(k % 3), state.velocity[k]);
  int column = body.root_freedoms();
  for (const PassiveJoint& group : body.groups) {
    const Joint& joint = body.skeleton.joints[std::size_t(group.joints[0])];
    for (int a = 0; a < group.axes; ++a)
      row(joint.name, joint.axes.col(group.first_axis + a), state.velocity[column + a]);
    column += group.axes;
  }
}

void run_case(const std::string& name, const Ragdoll& ragdoll, RagdollState state,
              const RagdollOptions& options, double seconds) {
  write_start(name + "_start.csv", ragdoll.body, state.body);
  std::ofstream out(name + "_course.csv");
  out << "time,energy";
  for (const std::string& joint : kSeen) out << fmt::format(",{0}_x,{0}_y,{0}_z", joint);
  const int every = int(std::lround(0.01 / options.step));
  for (int step = 0; state.time < seconds + options.step / 2; ++step) {
    if (step % every == 0) {
      body_frames(ragdoll.body, state.body.pose, state.frames);
      BodyState now = state.body;
      now.velocity = pose_velocity(state);
      out << fmt::format("\n{},{}", state.time,
                         body_energy(ragdoll.body, now, state.frames, options.gravity));
      for (const std::string& joint : kSeen) {
        const Vec3 at =
            state.frames.X_WJ[std::size_t(joint_of(ragdoll.body.skeleton, joint))].translation();
        out << fmt::format(",{},{},{}", at.x(), at.y(), at.z());
      }
    }
    step_ragdoll(ragdoll, options, state);
  }
  out << "\n";
}

void keep(const std::vector<std::string>& names, ArticulatedModel& body) {
  std::erase_if(body.groups, [&](const PassiveJoint& group) {
    const std::string& name = body.skeleton.joints[std::size_t(group.joints[0])].name;
    return std::ranges::find(names, name.substr(0, name.size() - 2)) == names.end();
  });
}

RagdollState started(Ragdoll& ragdoll) {
  RagdollState state;
  state.body.pose = rest_pose(ragdoll.body.skeleton);
  state.rest = set_frictionless(state.body.pose, ragdoll.body);
  state.body.velocity.setZero(ragdoll.body.freedoms());
  return state;
}

void write_cases(const std::string& character, const std::string& folder, double step) {
  Report report;
  const BoundCharacter bound = bind_character(test_assets(), read_character(character), report);
  const Ragdoll whole = character_ragdoll(character, bound.character, bound.binding, report);
  std::ofstream segments(folder + "/segments.csv");
  for (const BodySegment& each : whole.body.segments) {
    segments << fmt::format("{},{},{},{},{}",
                            whole.body.skeleton.joints[std::size_t(each.joint)].name, each.mass,
                            each.center.x(), each.center.y(), each.center.z());
    for (int k = 0; k < 9; ++k) segments << fmt::format(",{}", each.inertia(k / 3, k % 3));
    segments << "\n";
  }
  const RagdollOptions air{.step = step, .ground = false};

  Ragdoll thrown = whole;
  thrown.limbs.pairs.clear();
  keep({"hip", "knee", "ankle", "shoulder", "elbow"}, thrown.body);
  RagdollState flying = started(thrown);
  for (Eigen::Index i = 0; i < flying.body.velocity.size(); ++i)
    flying.body.velocity[i] = 1.5 * std::sin(3.0 * double(i) + 1);
  run_case(folder + "/flight", thrown, flying, air, 1);

  Ragdoll hung = whole;
  hung.limbs.pairs.clear();
  keep({"hip", "knee"}, hung.body);
  std::erase_if(hung.body.groups, [&](const PassiveJoint& group) {
    return hung.body.skeleton.joints[std::size_t(group.joints[0])].name.ends_with("_r");
  });
  hung.body.driven.assign(hung.body.skeleton.joints.size(), 1);
  for (std::size_t j = 1; j < hung.body.driven.size(); ++j) {
    const Joint& joint = hung.body.skeleton.joints[j];
    hung.body.driven[j] = joint.name != "hip_l" && hung.body.driven[std::size_t(joint.parent)];
  }
  RagdollState hanging = started(hung);
  hanging.body.driven.resize(hung.body.driven.size());
  hanging.body.velocity.setConstant(1.5);
  run_case(folder + "/pendulum", hung, hanging, air, 2);

  // Stiff as a board, dropped on its back, the feet a little lower.
  Ragdoll board = whole;
  board.limbs.pairs.clear();
  board.body.groups.clear();
  RagdollState dropping = started(board);
  std::vector<Transform> X_WJ;
  forward_kinematics(board.body.skeleton, dropping.body.pose, X_WJ);
  std::ofstream points(folder + "/points.csv");
  for (const CarriedPoint& point : board.points) {
    const Vec3 at = X_WJ[std::size_t(point.joint)] * point.place - X_WJ[0].translation();
    points << fmt::format("{},{},{}\n", at.x(), at.y(), at.z());
  }
  dropping.body.pose.rotations[0] = Eigen::AngleAxisd(-80 * kDegree, Vec3::UnitX());
  put_at_height(board, 0.3, dropping.body.pose);
  run_case(folder + "/drop", board, dropping, {.step = step, .flesh = 0}, 1);
}

}  // namespace
}  // namespace ecorche

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fputs("ragdoll_figures CHARACTER.glb FOLDER [STEPS A SECOND]\n", stderr);
    return 2;
  }
  ecorche::write_cases(argv[1], argv[2], 1 / (argc == 4 ? std::atof(argv[3]) : 4000.0));
}
