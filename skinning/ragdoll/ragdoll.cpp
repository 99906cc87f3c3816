#include "skinning/ragdoll/ragdoll.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "anatomy/joint_angles.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

// What the tables below say of a joint, or of a chain by its first one.
struct LooseJoint {
  std::string_view name;
  int first_axis, axes;
  double stiffness, damping;            // relaxed, Nm/rad and Nm s/rad
  double tone_stiffness, tone_damping;  // what full tone adds
  std::array<double, 3> loose;          // degrees
};

constexpr std::string_view kSpine[] = {"l5", "l4", "l3", "l2", "l1", "t12", "t11", "thorax"};
constexpr std::string_view kNeck[] = {"c7", "c6", "c5", "c4", "c3", "c2", "c1", "head"};

constexpr LooseJoint kLooseTrunk[] = {{"l5", 0, 3, 30, 8, 400, 20, {0, 0, 0}},
                                      {"c7", 0, 3, 4, 1.2, 40, 2, {0, 0, 0}}};
constexpr LooseJoint kLooseLimbs[] = {
    {"hip", 0, 3, 8, 4, 250, 12, {10, 5, 12}},      {"knee", 0, 1, 4, 2.5, 150, 6, {12, 0, 0}},
    {"ankle", 0, 1, 4, 0.8, 120, 3, {-25, 0, 0}},   {"subtalar", 2, 1, 4, 0.4, 40, 1, {0, 0, 6}},
    {"shoulder", 0, 3, 4, 2, 60, 3, {10, 15, 0}},   {"elbow", 0, 1, 2.5, 1, 40, 1.5, {25, 0, 0}},
    {"forearm", 2, 1, 0.8, 0.2, 8, 0.3, {0, 0, 0}}, {"wrist", 0, 3, 1, 0.2, 8, 0.3, {10, 0, 0}}};

// The girdle stays, and with it the last part of an arm's elevation.
constexpr double kShoulderElevation = 125 * kDegree;

constexpr double kPointSpacing = 0.025;  // m
constexpr double kSamePlace = 1e-6;      // m
constexpr int kFewestVertices = 12;      // of a joint that has points at all

const LooseJoint& loose_joint(const std::string& name) {
  for (const LooseJoint& each : kLooseTrunk)
    if (name == each.name) return each;
  for (const LooseJoint& each : kLooseLimbs)
    if (name == std::string(each.name) + "_l" || name == std::string(each.name) + "_r") return each;
  throw std::invalid_argument("set_tone: " + name + " is no joint of a ragdoll");
}

PassiveJoint loose_chain(const Skeleton& skeleton, std::span<const std::string_view> names) {
  PassiveJoint out;
  Vec3 sum = Vec3::Zero();
  for (const std::string_view name : names) {
    const int j = joint_of(skeleton, std::string(name));
    const Vec3 range = skeleton.joints[std::size_t(j)].max - skeleton.joints[std::size_t(j)].min;
    out.joints.push_back(j);
    out.shares.push_back(range);
    sum += range;
  }
  for (Vec3& share : out.shares) share = share.cwiseQuotient(sum);
  return out;
}

std::vector<PassiveJoint> loose_groups(const Skeleton& skeleton,
                                       const std::vector<std::string>& rigid) {
  std::vector<PassiveJoint> out;
  const auto add = [&](PassiveJoint group) {
    for (const int j : group.joints)
      if (std::ranges::find(rigid, skeleton.joints[std::size_t(j)].name) != rigid.end()) return;
    out.push_back(std::move(group));
  };
  add(loose_chain(skeleton, kSpine));
  add(loose_chain(skeleton, kNeck));
  for (const std::string side : {"_l", "_r"})
    for (const LooseJoint& each : kLooseLimbs) {
      PassiveJoint group;
      group.joints = {joint_of(skeleton, std::string(each.name) + side)};
      group.shares = {Vec3::Ones()};
      group.first_axis = each.first_axis;
      group.axes = each.axes;
      add(group);
    }
  return out;
}

// The outermost vertices of what a joint carries: along a cube's faces, then edges, then corners,
// those of the latter apart by kPointSpacing from those before. Left as right, so that a symmetric
// body has symmetric points.
void add_points(const std::vector<Vec3>& places, int joint, std::vector<CarriedPoint>& out) {
  if (int(places.size()) < kFewestVertices) return;
  std::vector<Vec3> kept;
  for (int parts = 1; parts <= 3; ++parts) {
    const std::size_t before = kept.size();
    const auto known = [&](const Vec3& place) {
      for (std::size_t k = 0; k < kept.size(); ++k)
        if ((kept[k] - place).norm() < (k < before ? kPointSpacing : kSamePlace)) return true;
      return false;
    };
    for (int way = 0; way < 27; ++way) {
      const Vec3 along(way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1);
      if (along.cwiseAbs().sum() != parts) continue;
      double far = -std::numeric_limits<double>::infinity();
      for (const Vec3& place : places) far = std::max(far, place.dot(along));
      for (const Vec3& place : places)
        if (place.dot(along) > far - kSamePlace && !known(place)) kept.push_back(place);
    }
  }
  for (const Vec3& place : kept) out.push_back({joint, place});
}

std::vector<CarriedPoint> outermost_points(const Skeleton& skeleton, const Points& skin,
                                           std::span<const JointWeights> weights) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  std::vector<std::vector<Vec3>> places(rest.size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const int j = std::ranges::max_element(weights[i], {}, &Influence::weight)->joint;
    places[std::size_t(j)].push_back(skin.row(Eigen::Index(i)).transpose() - rest[std::size_t(j)]);
  }
  std::vector<CarriedPoint> out;
  for (std::size_t j = 0; j < places.size(); ++j) add_points(places[j], int(j), out);
  return out;
}

std::vector<LooseFinger> loose_fingers(const Skeleton& skeleton) {
  std::vector<LooseFinger> out;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    const std::string part = joint.name.substr(0, 3);
    const double degrees = joint.name.starts_with("mcp1")   ? 10
                           : part == "mcp"                  ? 28
                           : part == "pip"                  ? 38
                           : part == "dip" || part == "ip1" ? 20
                                                            : 0;
    if (degrees == 0) continue;
    Vec3 angles = joint.zero;
    angles[0] = std::clamp(kDegree * degrees, joint.min[0], joint.max[0]);
    out.push_back({int(j), joint_rotation(joint, angles)});
  }
  return out;
}

}  // namespace

Ragdoll make_ragdoll(const Skeleton& skeleton, const std::vector<BodySegment>& segments,
                     const Points& skin, std::span<const JointWeights> weights,
                     const std::vector<std::string>& rigid) {
  if (Eigen::Index(weights.size()) != skin.rows())
    throw std::invalid_argument("make_ragdoll: weights of another skin");
  Ragdoll out;
  out.body.skeleton = skeleton;
  out.body.segments = segments;
  for (const std::string& name : rigid) joint_of(skeleton, name);
  out.body.groups = loose_groups(skeleton, rigid);
  out.points = outermost_points(skeleton, skin, weights);
  out.fingers = loose_fingers(skeleton);
  out.limbs = make_collision_tables(skeleton, measure_proxies(skeleton, skin));
  return out;
}

PassiveRest set_tone(double tone, const Pose& pose, ArticulatedModel& body) {
  PassiveRest out = passive_rest(body, pose);
  for (std::size_t g = 0; g < body.groups.size(); ++g) {
    PassiveJoint& group = body.groups[g];
    const LooseJoint& table = loose_joint(body.skeleton.joints[std::size_t(group.joints[0])].name);
    group.stiffness = table.stiffness + tone * table.tone_stiffness;
    group.damping = table.damping + tone * table.tone_damping;
    const double share = table.stiffness / group.stiffness;
    for (std::size_t k = 0; k < group.joints.size(); ++k) {
      Joint& joint = body.skeleton.joints[std::size_t(group.joints[k])];
      Vec3& angles = out.angles[g][k];
      if (table.name == "shoulder")
        for (int a = 0; a < 2; ++a)
          joint.max[a] = std::min(joint.max[a], std::max(angles[a], kShoulderElevation));
      const Vec3 loose = kDegree * Vec3(table.loose[0], table.loose[1], table.loose[2]);
      angles += share * (loose.cwiseMax(joint.min).cwiseMin(joint.max) - angles);
    }
  }
  return out;
}

void loosen_fingers(const Ragdoll& ragdoll, double share, Pose& pose) {
  for (const LooseFinger& finger : ragdoll.fingers) {
    Quat& rotation = pose.rotations[std::size_t(finger.joint)];
    rotation = rotation.slerp(share, finger.rotation);
  }
}

PassiveRest set_frictionless(const Pose& pose, ArticulatedModel& body) {
  for (PassiveJoint& group : body.groups) {
    group.stiffness = group.damping = 0;
    for (const int j : group.joints) {
      Joint& joint = body.skeleton.joints[std::size_t(j)];
      const bool swings = joint.max[1] > std::numbers::pi / 2;
      joint.min.setConstant(-100);
      joint.max.setConstant(100);
      if (!swings) joint.max[1] = std::numbers::pi / 2;
    }
  }
  return passive_rest(body, pose);
}

}  // namespace ecorche::inline v1
