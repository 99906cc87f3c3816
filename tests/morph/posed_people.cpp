#include "tests/morph/posed_people.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Dense>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

enum class Role {
  none,
  spine,
  neck,
  head,
  collar,
  arm,
  arm_twist,
  forearm,
  forearm_twist,
  hand,
  finger,
  thigh,
  shank,
  foot
};

struct RoleName {
  const char* prefix;
  Role role;
};
constexpr RoleName kRoles[] = {{"spine", Role::spine},      {"neck", Role::neck},
                               {"head", Role::head},        {"clavicle", Role::collar},
                               {"upperarm", Role::arm},     {"upperarm02", Role::arm_twist},
                               {"lowerarm", Role::forearm}, {"lowerarm02", Role::forearm_twist},
                               {"wrist", Role::hand},       {"hand", Role::hand},
                               {"finger", Role::finger},    {"thumb", Role::finger},
                               {"index", Role::finger},     {"middle", Role::finger},
                               {"ring", Role::finger},      {"pinky", Role::finger},
                               {"upperleg01", Role::thigh}, {"thigh", Role::thigh},
                               {"lowerleg01", Role::shank}, {"calf", Role::shank},
                               {"foot", Role::foot}};

Role role_of(const std::string& bone) {
  Role role = Role::none;
  for (const auto& [prefix, found] : kRoles)
    if (bone.starts_with(prefix)) role = found;
  return role;
}

int side_of(const std::string& bone) {
  return bone.ends_with(".L") || bone.ends_with("_l") ? 0 : 1;
}

// The segment, the default rig's bone that begins there, and who carries it in either rig.
struct JointName {
  const char* segment;
  const char* head_of;
  Role carrier;
  bool paired;
};
constexpr JointName kJoints[] = {
    {"neck", "neck01", Role::neck, false},      {"head", "head", Role::head, false},
    {"arm", "upperarm01", Role::arm, true},     {"forearm", "lowerarm01", Role::forearm, true},
    {"hand", "wrist", Role::hand, true},        {"thigh", "upperleg01", Role::thigh, true},
    {"shank", "lowerleg01", Role::shank, true}, {"foot", "foot", Role::foot, true}};

Mat3 rotation(const Vec3& turn) {
  const double angle = turn.norm();
  if (angle < 1e-12) return Mat3::Identity();
  return Eigen::AngleAxisd(angle, Vec3(turn / angle)).toRotationMatrix();
}

Mat3 between(const Vec3& from, const Vec3& to) {
  return Quat::FromTwoVectors(from, to).toRotationMatrix();
}

}  // namespace

StandingPose random_standing_pose(std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even(0, 1);
  const auto jitter = [&](double sd_degrees, double most_degrees = 20) {
    Vec3 turn(normal(random), normal(random), normal(random));
    turn *= sd_degrees * kDegree;
    if (turn.norm() > most_degrees * kDegree) turn *= most_degrees * kDegree / turn.norm();
    return rotation(turn);
  };
  const auto sided = [](Vec3 direction, int side) {
    if (side == 1) direction.x() *= -1;
    return direction.normalized();
  };
  StandingPose out;
  const int kind = int(random() % 8);
  constexpr const char* kNames[] = {"A",          "T",      "arms down",     "hands on hips",
                                    "arm raised", "a step", "feet together", "feet apart"};
  out.name = kNames[kind];
  const int chosen = int(random() % 2);
  for (int s = 0; s < 2; ++s) {
    Vec3 arm(0.18, -0.98, 0.0), forearm(0.12, -0.97, 0.2), thigh(0.05, -1, 0),
        shank(0.03, -1, -0.05);
    if (kind == 0) arm = Vec3(0.7, -0.7, 0.02), forearm = Vec3(0.68, -0.72, 0.12);
    if (kind == 1) arm = Vec3(1, 0, 0), forearm = Vec3(1, 0, 0.08);
    if (kind == 3) arm = Vec3(0.72, -0.68, -0.2), forearm = Vec3(-0.58, -0.74, 0.3);
    if (kind == 4 && s == chosen) {
      if (even(random) < 0.5) {
        arm = Vec3(0.35, 0.93, 0.1), forearm = Vec3(0.1, 0.97, 0.2);
      } else {
        arm = Vec3(0.2, 0.1, 0.97), forearm = Vec3(0.05, 0.25, 0.97);
      }
    }
    if (kind == 5) {
      const double stride = (s == chosen ? 1 : -1) * (0.15 + 0.2 * even(random));
      thigh = Vec3(0.03, -1, stride);
      shank = stride > 0 ? Vec3(0.02, -1, 0.7 * stride) : Vec3(0.02, -0.95, 1.8 * stride);
      arm.z() -= 0.6 * stride;
    }
    if (kind == 6) thigh = shank = Vec3(-0.02, -1, 0);
    if (kind == 7) thigh = Vec3(0.2 + 0.15 * even(random), -1, 0), shank = thigh;
    const double bend = kind == 3 ? 3 : 8;
    out.arm[s] = jitter(bend) * sided(arm, s);
    out.forearm[s] = jitter(bend) * sided(forearm, s);
    out.thigh[s] = jitter(3, 8) * sided(thigh, s);
    // Knees bend backwards only.
    Vec3 lower = jitter(2, 6) * sided(shank, s);
    const double forwards = lower.z() - out.thigh[s].z();
    if (forwards > 0) lower.z() -= forwards;
    out.shank[s] = lower.normalized();
    if (kind == 3) {
      out.hand[s] = jitter(6) * sided(Vec3(-0.35, -0.6, 0.72), s);
    } else {
      out.pronation[s] = 20 * kDegree * std::clamp(normal(random), -2.0, 2.0);
      out.hand_jitter[s] = jitter(6);
    }
    out.curl[s] = 18 * kDegree * even(random);
    out.foot_jitter[s] = rotation(Vec3(0, (s == 0 ? 1 : -1) * 10 * kDegree * even(random), 0));
  }
  out.spine = Vec3(6 * normal(random) + 3, 7 * normal(random), 4 * normal(random)) * kDegree;
  out.head = Vec3(7 * normal(random), 9 * normal(random), 4 * normal(random)) * kDegree;
  for (Vec3* turn : {&out.spine, &out.head})
    *turn = turn->cwiseMax(-20 * kDegree).cwiseMin(20 * kDegree);
  return out;
}

struct PersonPoser::Placed {
  Points skin;
  std::vector<Landmark> joints;
};

PersonPoser::PersonPoser(const BodyPackage& package, const std::string& rig)
    : package_(package),
      rig_(read_rig(package, rig, package.points)),
      parts_(vertex_parts(package)),
      neighbours_(std::size_t(package.skin_size)) {
  std::vector<std::set<int>> sets(neighbours_.size());
  for (Eigen::Index q = 0; q < package.quads.rows(); ++q)
    for (int k = 0; k < 4; ++k) {
      const int a = package.quads(q, k), b = package.quads(q, (k + 1) % 4);
      sets[std::size_t(a)].insert(b);
      sets[std::size_t(b)].insert(a);
    }
  for (std::size_t i = 0; i < sets.size(); ++i)
    neighbours_[i].assign(sets[i].begin(), sets[i].end());
  std::vector<char> inner(neighbours_.size(), 0);
  for (const Cavity& cavity : package.cavities)
    for (const int q : cavity.quads)
      for (int k = 0; k < 4; ++k) inner[std::size_t(package.quads(q, k))] = 1;
  for (std::size_t i = 0; i < inner.size(); ++i)
    if (!inner[i]) outer_.push_back(int(i));
  const Rig own = read_rig(package, "default", package.points);
  std::vector<Vec3> heads;
  for (const JointName& joint : kJoints)
    for (int s = 0; s < (joint.paired ? 2 : 1); ++s) {
      std::string name = joint.segment, bone = joint.head_of;
      if (joint.paired) {
        name += s == 0 ? "_l" : "_r";
        bone += s == 0 ? ".L" : ".R";
      }
      const auto found = std::find(own.names.begin(), own.names.end(), bone);
      if (found == own.names.end()) throw InputError("no bone " + bone + " in the default rig");
      int carrier = -1;
      for (std::size_t b = 0; b < rig_.names.size() && carrier < 0; ++b)
        if (role_of(rig_.names[b]) == joint.carrier &&
            (!joint.paired || side_of(rig_.names[b]) == s))
          carrier = int(b);
      if (carrier < 0) throw InputError("nothing carries " + name + " in the rig " + rig);
      joint_names_.push_back(name);
      joint_bones_.push_back(carrier);
      heads.push_back(own.heads[std::size_t(found - own.names.begin())]);
    }
  joint_heads_.resize(Eigen::Index(heads.size()), 3);
  for (std::size_t j = 0; j < heads.size(); ++j)
    joint_heads_.row(Eigen::Index(j)) = heads[j].transpose();
}

// Points of the package's own shape in a person: an affine map of the skin around each.
Points PersonPoser::carried(const Points& from, const Points& rest) const {
  constexpr double kReach = 0.07;  // m
  Points out(from.rows(), 3);
  for (Eigen::Index j = 0; j < from.rows(); ++j) {
    const Vec3 p = from.row(j);
    Eigen::Matrix4d A = Eigen::Matrix4d::Identity() * 1e-9;
    Eigen::Matrix<double, 4, 3> B = Eigen::Matrix<double, 4, 3>::Zero();
    double nearest = 1;
    for (const int i : outer_)
      nearest = std::min(nearest, (package_.points.row(i).transpose() - p).norm());
    for (const int i : outer_) {
      const Vec3 q = package_.points.row(i).transpose() - p;
      const double d = q.norm() - nearest;
      if (d > 3 * kReach) continue;
      const double w = std::exp(-d * d / (2 * kReach * kReach));
      const Eigen::Vector4d x(q.x(), q.y(), q.z(), 1);
      A += w * x * x.transpose();
      B += w * x * rest.row(i);
    }
    const Eigen::Matrix<double, 4, 3> map = A.ldlt().solve(B);
    out.row(j) = map.row(3);
  }
  return out;
}

Points PersonPoser::smoothed(const Points& points) const {
  Points now = points, next = points;
  for (int round = 0; round < 8; ++round) {
    for (std::size_t i = 0; i < neighbours_.size(); ++i) {
      if (neighbours_[i].empty()) continue;
      Vec3 sum = Vec3::Zero();
      for (const int n : neighbours_[i]) sum += now.row(n).transpose();
      next.row(Eigen::Index(i)) =
          0.5 * now.row(Eigen::Index(i)) + 0.5 * sum.transpose() / double(neighbours_[i].size());
    }
    now.swap(next);
  }
  return now;
}

std::vector<Mat3> PersonPoser::frames(const Points& points) const {
  Points normals = Points::Zero(points.rows(), 3);
  for (Eigen::Index f = 0; f < package_.triangles.rows(); ++f) {
    const Vec3 a = points.row(package_.triangles(f, 0)), b = points.row(package_.triangles(f, 1)),
               c = points.row(package_.triangles(f, 2));
    for (int k = 0; k < 3; ++k)
      normals.row(package_.triangles(f, k)) += (b - a).cross(c - a).transpose();
  }
  std::vector<Mat3> out(std::size_t(points.rows()), Mat3::Identity());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Eigen::Index row = Eigen::Index(i);
    if (neighbours_[i].empty() || normals.row(row).norm() < 1e-14) continue;
    const Vec3 n = normals.row(row).transpose().normalized();
    Vec3 t = (points.row(neighbours_[i][0]) - points.row(row)).transpose();
    t -= t.dot(n) * n;
    if (t.norm() < 1e-9) continue;
    t.normalize();
    out[i] << t, n.cross(t), n;
  }
  return out;
}

PersonPoser::Placed PersonPoser::place(const Points& rest, const StandingPose& pose) const {
  const std::size_t count = rig_.names.size();
  Points ends(Eigen::Index(2 * count), 3);
  for (std::size_t b = 0; b < count; ++b) {
    ends.row(Eigen::Index(b)) = rig_.heads[b].transpose();
    ends.row(Eigen::Index(count + b)) = rig_.tails[b].transpose();
  }
  ends = carried(ends, rest);
  const auto head = [&](std::size_t b) -> Vec3 { return ends.row(Eigen::Index(b)).transpose(); };
  const auto tail = [&](std::size_t b) -> Vec3 {
    return ends.row(Eigen::Index(count + b)).transpose();
  };
  const auto find = [&](Role role, int side) {
    for (std::size_t b = 0; b < count; ++b)
      if (role_of(rig_.names[b]) == role && side_of(rig_.names[b]) == side) return b;
    throw InputError("the rig " + rig_.name + " lacks a limb");
  };
  int spines = 0, necks = 0;
  bool twists = false;
  for (const std::string& name : rig_.names) {
    spines += role_of(name) == Role::spine;
    necks += role_of(name) == Role::neck;
    twists = twists || role_of(name) == Role::arm_twist;
  }
  std::vector<Mat3> turn(count);
  std::vector<Vec3> place(count);
  double axial[2] = {0, 0};
  for (std::size_t b = 0; b < count; ++b) {
    const int p = rig_.parents[b];
    const Mat3 above = p < 0 ? Mat3(Mat3::Identity()) : turn[std::size_t(p)];
    place[b] =
        p < 0 ? head(b) : Vec3(place[std::size_t(p)] + above * (head(b) - head(std::size_t(p))));
    turn[b] = above;
    const int s = side_of(rig_.names[b]);
    // Limb directions run from joint to joint.
    const auto along = [&](Role from, Role to) -> Vec3 {
      return (head(find(to, s)) - head(find(from, s))).normalized();
    };
    switch (role_of(rig_.names[b])) {
      case Role::spine:
        turn[b] = above * rotation(pose.spine / spines);
        break;
      case Role::neck:
        turn[b] = above * rotation(0.5 * pose.head / necks);
        break;
      case Role::head:
        turn[b] = above * rotation(0.5 * pose.head);
        break;
      case Role::collar: {
        // A quarter of the arm's raising.
        const Mat3 raised = between(above * along(Role::arm, Role::forearm), pose.arm[s]);
        turn[b] = Quat::Identity().slerp(0.25, Quat(raised)).toRotationMatrix() * above;
        break;
      }
      case Role::arm: {
        const Vec3 rest_arm = along(Role::arm, Role::forearm),
                   rest_forearm = along(Role::forearm, Role::hand);
        const Mat3 raised = between(above * rest_arm, pose.arm[s]) * above;
        Vec3 hinge = rest_arm.cross(rest_forearm);
        if (hinge.norm() < 0.05) hinge = rest_arm.cross(Vec3::UnitZ());
        const Vec3 has = (raised * hinge).normalized(), wants = pose.arm[s].cross(pose.forearm[s]);
        if (wants.norm() > 0.15)
          axial[s] = std::clamp(std::atan2(has.cross(wants).dot(pose.arm[s]), has.dot(wants)),
                                -80 * kDegree, 80 * kDegree);
        if (!twists) axial[s] = std::clamp(axial[s], -40 * kDegree, 40 * kDegree);
        turn[b] = rotation(pose.arm[s] * axial[s] * (twists ? 0.4 : 1)) * raised;
        break;
      }
      case Role::arm_twist:
        turn[b] = rotation(pose.arm[s] * axial[s] * 0.6) * above;
        break;
      case Role::forearm:
        turn[b] = between(above * along(Role::forearm, Role::hand), pose.forearm[s]) * above;
        break;
      case Role::forearm_twist:
        turn[b] = rotation(pose.forearm[s] * pose.pronation[s]) * above;
        break;
      case Role::hand:
        if (pose.hand[s].norm() > 0.5)
          turn[b] = between(above * (tail(b) - head(b)).normalized(), pose.hand[s]) * above;
        else
          turn[b] = pose.hand_jitter[s] * above;
        break;
      case Role::finger: {
        // About the axis that the finger is bent about at rest.
        std::size_t last = b, first = b;
        for (std::size_t k = b + 1; k < count; ++k)
          if (rig_.parents[k] == int(last) && role_of(rig_.names[k]) == Role::finger) last = k;
        while (rig_.parents[first] >= 0 &&
               role_of(rig_.names[std::size_t(rig_.parents[first])]) == Role::finger)
          first = std::size_t(rig_.parents[first]);
        const Vec3 a = (tail(first) - head(first)).normalized(),
                   c = (tail(last) - head(last)).normalized();
        if (a.cross(c).norm() > 0.05)
          turn[b] = above * rotation(a.cross(c).normalized() * pose.curl[s]);
        break;
      }
      case Role::thigh:
        turn[b] = between(above * along(Role::thigh, Role::shank), pose.thigh[s]) * above;
        break;
      case Role::shank:
        turn[b] = between(above * along(Role::shank, Role::foot), pose.shank[s]) * above;
        break;
      case Role::foot:
        turn[b] = pose.foot_jitter[s];  // flat on the floor
        break;
      case Role::none:
        break;
    }
  }
  Placed out;
  out.skin.resize(rest.rows(), 3);
  for (Eigen::Index i = 0; i < rest.rows(); ++i) {
    Vec3 sum = Vec3::Zero();
    for (int k = rig_.weights.start[std::size_t(i)]; k < rig_.weights.start[std::size_t(i) + 1];
         ++k) {
      const std::size_t b = std::size_t(rig_.weights.bone[std::size_t(k)]);
      sum += rig_.weights.weight[std::size_t(k)] *
             (turn[b] * (rest.row(i).transpose() - head(b)) + place[b]);
    }
    out.skin.row(i) = sum.transpose();
  }
  const Points joints = carried(joint_heads_, rest);
  for (std::size_t j = 0; j < joint_names_.size(); ++j) {
    const std::size_t b = std::size_t(joint_bones_[j]);
    const Vec3 at = joints.row(Eigen::Index(j)).transpose();
    out.joints.push_back({joint_names_[j], turn[b] * (at - head(b)) + place[b]});
  }
  return out;
}

PosedPerson PersonPoser::pose(const Points& rest, StandingPose pose) const {
  Placed placed = place(rest, pose);
  // Vertices of a group that lie in another: behind its nearest vertex.
  const auto gather = [&](auto&& in) {
    std::vector<int> out;
    for (const int i : outer_)
      if (in(parts_[std::size_t(i)])) out.push_back(i);
    return out;
  };
  const auto lies_in = [&](const std::vector<int>& a, const std::vector<int>& b,
                           const std::vector<Mat3>& frame) {
    for (const int i : a) {
      double best = 0.06 * 0.06;
      int at = -1;
      for (const int k : b) {
        const double d = (placed.skin.row(i) - placed.skin.row(k)).squaredNorm();
        if (d < best) best = d, at = k;
      }
      if (at >= 0 &&
          (placed.skin.row(i) - placed.skin.row(at)).dot(frame[std::size_t(at)].col(2)) < 0.002)
        return true;
    }
    return false;
  };
  for (int tries = 0; tries < 14; ++tries) {
    const std::vector<Mat3> frame = frames(placed.skin);
    bool moved = false;
    const auto leg = [&](Side side) {
      return gather([&](VertexPart p) {
        return p.side == side && (p.part == BodyPart::shank || p.part == BodyPart::foot);
      });
    };
    for (int s = 0; s < 2; ++s) {
      const Side side = s == 0 ? Side::left : Side::right;
      const std::vector<int> arm = gather([&](VertexPart p) {
        return p.side == side && (p.part == BodyPart::forearm || p.part == BodyPart::hand);
      });
      const std::vector<int> trunk = gather([&](VertexPart p) {
        return p.part == BodyPart::trunk || p.part == BodyPart::thigh || p.part == BodyPart::head;
      });
      if (!lies_in(arm, trunk, frame)) continue;
      const bool high = pose.arm[s].y() > 0;
      const Mat3 out = rotation(Vec3(0, 0, (s == 0 ? 1 : -1) * (high ? -4 : 4) * kDegree));
      pose.arm[s] = out * pose.arm[s];
      pose.forearm[s] = out * pose.forearm[s];
      moved = true;
    }
    if (lies_in(leg(Side::left), leg(Side::right), frame)) {
      for (int s = 0; s < 2; ++s) {
        const Mat3 out = rotation(Vec3(0, 0, (s == 0 ? 1 : -1) * kDegree));
        pose.thigh[s] = out * pose.thigh[s];
        pose.shank[s] = out * pose.shank[s];
      }
      moved = true;
    }
    if (!moved) break;
    placed = place(rest, pose);
  }
  // Details of the rest skin over its smooth form, put on the smooth form of the posed one.
  const Points smooth_rest = smoothed(rest), smooth_posed = smoothed(placed.skin);
  const std::vector<Mat3> before = frames(smooth_rest), after = frames(smooth_posed);
  PosedPerson out;
  out.skin.resize(rest.rows(), 3);
  for (Eigen::Index i = 0; i < rest.rows(); ++i)
    out.skin.row(i) =
        smooth_posed.row(i) + (after[std::size_t(i)] * before[std::size_t(i)].transpose() *
                               (rest.row(i) - smooth_rest.row(i)).transpose())
                                  .transpose();
  double floor = 1e9;
  for (const int i : outer_) floor = std::min(floor, out.skin(i, 1));
  out.skin.col(1).array() -= floor;
  out.joints = std::move(placed.joints);
  for (Landmark& joint : out.joints) joint.position.y() -= floor;
  return out;
}

}  // namespace ecorche
