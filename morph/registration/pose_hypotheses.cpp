#include "morph/registration/pose_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace ecorche::inline v1 {
namespace {

// A limb bent by less does not tell which way its hinge looks, cosine.
constexpr double kStraight = 0.94;

Vec3 mirrored(const Vec3& v, Side side) {
  return side == Side::right ? Vec3(-v.x(), v.y(), v.z()) : v;
}

std::string sided(const char* name, Side side) { return std::string(name) + side_suffix(side); }

Mat3 world_turn(const ArticulatedBody& body, const std::vector<Mat3>& turns, int joint) {
  Mat3 out = Mat3::Identity();
  for (int j = joint; j > 0; j = body.joints[std::size_t(j)].parent)
    out = turns[std::size_t(j)] * out;
  return out;
}

// A limb's upper segment: degrees above the level, and from the side to the front.
struct Reach {
  double up, forward;
};
constexpr Reach kArmReach[] = {{-80, 0}, {-45, -60}, {-45, 0}, {-45, 60}, {-45, 110},
                               {0, -30}, {0, 20},    {0, 70},  {0, 115},  {40, 0},
                               {40, 60}, {40, 110},  {80, 60}};
constexpr Reach kLegReach[] = {{-85, 0},  {-60, -90}, {-60, 0}, {-60, 90},
                               {-30, 30}, {-30, 90},  {5, 45},  {5, 95}};
constexpr double kArmBends[] = {55, 105, 140}, kLegBends[] = {50, 100, 135};
constexpr int kArmWays = 8, kLegWays = 1;

std::vector<LimbPose> make_grid(std::span<const Reach> reach, std::span<const double> bends,
                                int ways) {
  std::vector<LimbPose> out;
  for (const Reach& one : reach) {
    const double up = one.up * kDegree, forward = one.forward * kDegree;
    const Vec3 upper(std::cos(up) * std::cos(forward), std::sin(up),
                     std::cos(up) * std::sin(forward));
    out.push_back({"straight", upper, upper});
    // Knees bend backwards, elbows any way that the upper arm is turned to.
    const Vec3 knee = Vec3::UnitX().cross(upper);
    const Vec3 back = ways > 1 ? Vec3(0.3, -1, 0.2) : knee.norm() > 0.3 ? knee : Vec3(0, -1, 0);
    const Vec3 first = (back - back.dot(upper) * upper).normalized(), second = upper.cross(first);
    for (const double bend : bends) {
      for (int way = 0; way < ways; ++way) {
        const double angle = 2 * std::numbers::pi * way / ways;
        const Vec3 side = std::cos(angle) * first + std::sin(angle) * second;
        out.push_back(
            {"bent", upper, std::cos(bend * kDegree) * upper + std::sin(bend * kDegree) * side});
      }
    }
  }
  return out;
}

const LimbPose& named(const std::vector<LimbPose>& poses, const char* name) {
  return *std::find_if(poses.begin(), poses.end(),
                       [&](const LimbPose& pose) { return std::string(pose.name) == name; });
}

}  // namespace

const std::vector<LimbPose>& arm_poses() {
  static const std::vector<LimbPose> poses{{"a-pose", {0.65, -0.76, 0}, {0.65, -0.76, 0.05}},
                                           {"down", {0.2, -0.98, 0}, {0.12, -0.98, 0.12}},
                                           {"t-pose", {1, 0, 0}, {1, 0, 0.05}},
                                           {"up", {0.3, 0.95, 0}, {0.15, 1, 0}},
                                           {"y", {0.8, 0.6, 0}, {0.8, 0.6, 0}},
                                           {"forward", {0.15, 0, 1}, {0, 0, 1}},
                                           {"forward down", {0.25, -0.75, 0.6}, {0.1, -0.7, 0.7}},
                                           {"hips", {0.75, -0.6, -0.25}, {-0.5, -0.6, 0.5}},
                                           {"cactus", {1, 0, 0}, {0.1, 1, 0}},
                                           {"forearm forward", {0.2, -0.98, 0}, {0, -0.1, 1}},
                                           {"folded", {0.35, -0.85, 0.35}, {-0.8, 0.2, 0.5}},
                                           {"back", {0.4, -0.75, -0.55}, {0.35, -0.75, -0.55}},
                                           {"head", {0.9, 0.25, 0.15}, {-0.6, 0.8, 0.1}},
                                           {"boxing", {0.3, -0.8, 0.4}, {-0.1, 0.8, 0.6}},
                                           {"side, forward", {0.9, -0.2, 0.2}, {0.1, -0.1, 1}},
                                           {"high, bent", {0.75, 0.55, 0.2}, {-0.3, 0.9, 0.3}},
                                           {"low, bent", {0.6, -0.75, 0.1}, {0.4, -0.2, 0.9}}};
  return poses;
}

const std::vector<LimbPose>& leg_poses() {
  static const std::vector<LimbPose> poses{{"straight", {0.04, -1, 0}, {0.02, -1, 0}},
                                           {"apart", {0.3, -0.95, 0}, {0.3, -0.95, 0}},
                                           {"forward", {0.05, -0.92, 0.4}, {0.03, -0.98, 0.2}},
                                           {"back", {0.05, -0.95, -0.3}, {0.03, -0.9, -0.45}},
                                           {"knee raised", {0.1, -0.6, 0.8}, {0.05, -1, 0}},
                                           {"thigh level", {0.15, 0.1, 1}, {0.1, -1, -0.1}},
                                           {"shank back", {0.05, -1, 0.05}, {0, -0.4, -0.9}},
                                           {"sideways", {0.65, -0.75, 0}, {0.65, -0.75, 0}},
                                           {"squat", {0.4, -0.35, 0.85}, {0.1, -0.95, -0.4}},
                                           {"kick", {0.1, -0.4, 0.9}, {0.1, -0.4, 0.9}},
                                           {"lunge", {0.1, -0.75, 0.65}, {0.05, -0.98, -0.15}}};
  return poses;
}

const std::vector<LimbPose>& limb_grid(bool arm) {
  static const std::vector<LimbPose> arms = make_grid(kArmReach, kArmBends, kArmWays),
                                     legs = make_grid(kLegReach, kLegBends, kLegWays);
  return arm ? arms : legs;
}

void set_limb(const ArticulatedBody& body, bool arm, Side side, const LimbPose& limb,
              std::vector<Mat3>& turns) {
  const int upper = find_segment(body, sided(arm ? "arm" : "thigh", side));
  const int lower = find_segment(body, sided(arm ? "forearm" : "shank", side));
  const int end = find_segment(body, sided(arm ? "hand" : "foot", side));
  const auto segment = [&](int from, int to) {
    return Vec3((body.joint_mean.row(to) - body.joint_mean.row(from)).transpose().normalized());
  };
  const Vec3 upper_rest = segment(upper, lower), lower_rest = segment(lower, end);
  const Vec3 upper_goal = mirrored(limb.upper, side).normalized(),
             lower_goal = mirrored(limb.lower, side).normalized();
  const int twist = body.joints[std::size_t(lower)].parent;
  turns[std::size_t(twist)].setIdentity();
  const Mat3 before = world_turn(body, turns, body.joints[std::size_t(upper)].parent);
  Mat3 own = Quat::FromTwoVectors(before * upper_rest, upper_goal).toRotationMatrix() * before;
  const Vec3 hinge = body.joints[std::size_t(lower)].hinge;
  if (upper_goal.dot(lower_goal) < kStraight) {
    // About the upper segment, until the hinge bends it the right way.
    const Vec3 wanted = upper_goal.cross(lower_goal).normalized();
    const Vec3 is = (own * hinge - upper_goal * upper_goal.dot(own * hinge)).normalized();
    const double angle = std::atan2(upper_goal.dot(is.cross(wanted)), is.dot(wanted));
    own = Eigen::AngleAxisd(angle, upper_goal).toRotationMatrix() * own;
  }
  turns[std::size_t(upper)] = before.transpose() * own;
  const Mat3 low = Quat::FromTwoVectors(own * lower_rest, lower_goal).toRotationMatrix() * own;
  turns[std::size_t(lower)] = own.transpose() * low;
  if (!arm) {
    // Feet stay as they are in the world, half of the way.
    const Quat half = Quat::Identity().slerp(0.5, Quat(Mat3(low.transpose())));
    turns[std::size_t(end)] = half.toRotationMatrix();
  }
}

std::vector<BodyPose> standing_poses(const ArticulatedBody& body) {
  struct Stance {
    const char* name;
    const char* left;
    const char* right;
  };
  constexpr Stance kStances[] = {{"standing", "straight", "straight"},
                                 {"feet apart", "apart", "apart"},
                                 {"left step", "forward", "back"},
                                 {"right step", "back", "forward"},
                                 {"left knee raised", "knee raised", "straight"},
                                 {"right knee raised", "straight", "knee raised"},
                                 {"squat", "squat", "squat"}};
  struct Trunk {
    const char* name;
    Vec3 turn;  // of each of loin, trunk and chest, rad
  };
  const Trunk trunks[] = {{"", Vec3::Zero()}, {", bent", {0.35, 0, 0}}};
  std::vector<BodyPose> out;
  for (const Stance& stance : kStances) {
    for (const char* arms : {"a-pose", "down", "t-pose", "up", "forward", "hips", "y"}) {
      for (const Trunk& trunk : trunks) {
        const bool plain = std::string(stance.name) == "standing";
        // Rare together.
        if (!plain && trunk.turn.norm() > 0 && std::string(stance.name) != "squat") continue;
        BodyPose pose{std::string(stance.name) + ", arms " + arms + trunk.name,
                      std::vector<Mat3>(body.joints.size(), Mat3::Identity())};
        if (trunk.turn.norm() > 0)
          for (const char* joint : {"loin", "trunk", "chest"})
            pose.turns[std::size_t(find_segment(body, joint))] =
                Eigen::AngleAxisd(trunk.turn.norm(), trunk.turn.normalized()).toRotationMatrix();
        for (const Side side : {Side::left, Side::right}) {
          set_limb(body, true, side, named(arm_poses(), arms), pose.turns);
          set_limb(body, false, side,
                   named(leg_poses(), side == Side::left ? stance.left : stance.right), pose.turns);
        }
        out.push_back(std::move(pose));
      }
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
