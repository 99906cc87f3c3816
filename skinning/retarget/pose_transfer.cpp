#include "skinning/retarget/pose_transfer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/joint_angles.h"
#include "skinning/motion/shoulder_rhythm.h"

namespace ecorche::inline v1 {
namespace {
constexpr std::array<const char*, 2> kSides = {"_l", "_r"};
constexpr double kLean = 0.3;  // sine of a bend; below it the lower bone's bearing is damped
constexpr std::array<const char*, 8> kSpine = {"l5", "l4",  "l3",  "l2",
                                               "l1", "t12", "t11", "thorax"};
constexpr std::array<const char*, 8> kNeck = {"c7", "c6", "c5", "c4", "c3", "c2", "c1", "head"};

Side side_of(const std::string& name) {
  return name.ends_with("_l") ? Side::left : name.ends_with("_r") ? Side::right : Side::middle;
}

// The twist of q about `axis` (swing-twist decomposition).
Quat twist_of(const Quat& q, const Vec3& axis) {
  const Quat twist(q.w(), axis.x() * q.vec().dot(axis), axis.y() * q.vec().dot(axis),
                   axis.z() * q.vec().dot(axis));
  return twist.norm() > 1e-12 ? twist.normalized() : Quat::Identity();
}

// The identity up to `from`, then saturating towards `to`.
double soft_limit(double x, double from, double to) {
  return x < from ? x : to - (to - from) * std::exp(-(x - from) / (to - from));
}

// Flexion of the fingers of a relaxed hand from the anatomical zero, rad, for files without
// fingers.
double relaxed_flexion(const std::string& stem) {
  if (stem.starts_with("mcp") && stem != "mcp1") return 25 * kDegree;
  if (stem.starts_with("pip")) return 35 * kDegree;
  if (stem.starts_with("dip")) return 15 * kDegree;
  if (stem == "mcp1" || stem == "ip1") return 12 * kDegree;
  return 0;
}

// The rotation without the components of axes with next to no range: a hinge only bends, a knuckle
// has no axial rotation.
Quat without_locked_axes(const Joint& joint, const Mat3& zero, const Quat& turn) {
  Vec3 angles = joint_angles(joint, turn, zero);
  for (int a : {1, 2})
    if (joint.max[a] - joint.min[a] < 5 * kDegree)
      angles[a] = std::clamp(angles[a], joint.min[a], joint.max[a]);
  return joint_rotation(joint, angles, zero);
}

}  // namespace

PoseTransfer::PoseTransfer(const MotionClip& source, const JointMapping& mapping,
                           const RestAlignment& alignment, const MatchingRig* matching_rig,
                           const Skeleton& our_skeleton, bool shoulder_rhythm)
    : source_(source),
      mapping_(mapping),
      alignment_(alignment),
      matching_rig_(matching_rig),
      skeleton_(our_skeleton),
      rhythm_(shoulder_rhythm),
      rest_(rest_positions(our_skeleton)) {
  double leg = 0;
  for (const std::string s : kSides)
    leg += 0.5 * ((rest_[ours("knee" + s)] - rest_[ours("hip" + s)]).norm() +
                  (rest_[ours("ankle" + s)] - rest_[ours("knee" + s)]).norm());
  scale_ = matching_rig ? matching_rig->metres : leg / alignment.leg;
  plans_.resize(skeleton_.joints.size());
  R_.resize(skeleton_.joints.size());
  for (size_t j = 0; j < plans_.size(); ++j)
    if (has(skeleton_.joints[j].name)) plans_[j] = Plan{Rule::direct, skeleton_.joints[j].name};
  plan_trunk();
  plan_limbs();
  plan_sides();
  for (const Joint& joint : skeleton_.joints) zeros_.push_back(joint_zero(joint));
  for (size_t j = 0; j < plans_.size(); ++j) {
    Plan& p = plans_[j];
    if (p.rule == Rule::finger) p.still = p.relaxed.toRotationMatrix();
    if ((p.rule == Rule::finger || p.rule == Rule::follow) && !alignment_.same_rest)
      p.still =
          without_locked_axes(skeleton_.joints[j], zeros_[j], Quat(p.still)).toRotationMatrix();
  }
}

int PoseTransfer::ours(const std::string& name) const {
  const int j = find_joint(skeleton_, name);
  if (j < 0) throw std::invalid_argument("retarget: our skeleton has no joint '" + name + "'");
  return j;
}

// Positions of the file's joints along the chain, 0 .. 1: a bone's rotation is that at its middle.
std::vector<PoseTransfer::Knot> PoseTransfer::knots(const std::string& from,
                                                    const std::vector<int>& chain,
                                                    const std::string& to, bool from_base) const {
  const int end = mapping_.position_joint.at(to);
  std::vector<int> stops = chain;
  stops.push_back(end);
  std::vector<double> along = {from_base ? 0 : source_.joints[stops[0]].offset.norm()};
  for (size_t k = 1; k < stops.size(); ++k)
    along.push_back(along.back() + source_.joints[stops[k]].offset.norm());
  const double total = along.back();
  std::vector<Knot> out = {{0, file_turn(from)}};
  // A spine or neck joint of the file has the rest alignment of the trunk.
  for (size_t k = 0; k + 1 < stops.size(); ++k)
    out.push_back({total > 0 ? 0.5 * (along[k] + along[k + 1]) / total : (k + 1.0) / stops.size(),
                   {stops[k], alignment_.W, alignment_.trunk.at(stops[k])}});
  out.push_back({1, file_turn(to)});
  return out;
}

void PoseTransfer::plan_trunk() {
  spine_knots_ = knots("pelvis", mapping_.spine, "thorax", false);
  neck_knots_ = knots("thorax", mapping_.neck, "head", true);
  // Each joint takes a fraction in proportion to its range of motion: bending mostly lumbar spine
  // and middle of the neck, axial rotation mostly thorax and c1.
  auto plan = [&](const auto& chain, Rule rule) {
    Vec3 total = Vec3::Zero(), so_far = Vec3::Zero();
    auto range = [&](const char* name) {
      return Vec3(skeleton_.joints[ours(name)].max - skeleton_.joints[ours(name)].min);
    };
    for (const char* name : chain) total += range(name);
    for (const char* name : chain) {
      so_far += range(name);
      if (Plan& p = plans_[ours(name)]; p.rule == Rule::follow) {
        p.rule = rule;
        p.bending = so_far[0] / total[0];
        p.turning = so_far[2] / total[2];
      }
    }
  };
  plan(kSpine, Rule::spine);
  plan(kNeck, Rule::neck);
}

void PoseTransfer::plan_limbs() {
  for (const std::string s : kSides) {
    auto take = [&](const char* stem, Rule rule) {
      if (Plan& p = plans_[ours(stem + s)]; p.rule == Rule::follow) p.rule = rule;
    };
    if (Plan& p = plans_[ours("clavicle" + s)]; p.rule == Rule::direct && !alignment_.same_rest)
      p.rule = Rule::collar;
    if (rhythm_) take("clavicle", Rule::clavicle), take("scapula", Rule::scapula);
    // Where the shoulder is, the collar tells (matching_rig.h).
    if (matching_rig_ && mapping_.outer_collars.contains("scapula" + s))
      plans_[ours("scapula" + s)].rule = Rule::blade;
    if (!has("forearm" + s))
      plans_[ours("elbow" + s)].rule = Rule::elbow,
                            plans_[ours("forearm" + s)].rule = Rule::forearm;
    if (!has("subtalar" + s))
      plans_[ours("ankle" + s)].rule = Rule::ankle,
                            plans_[ours("subtalar" + s)].rule = Rule::subtalar;
  }
  for (size_t j = 0; j < plans_.size(); ++j) {
    Plan& p = plans_[j];
    const std::string& name = skeleton_.joints[j].name;
    const Side side = side_of(name);
    if (p.rule != Rule::follow || side == Side::middle) continue;
    const std::string stem = name.substr(0, name.size() - 2);
    if (stem.starts_with("mtp") && has("toes" + std::string(side_suffix(side)))) {
      p = Plan{Rule::direct, "toes" + std::string(side_suffix(side))};
    } else if (const double flexion = matching_rig_ ? 0 : relaxed_flexion(stem); flexion > 0) {
      p.rule = Rule::finger;
      p.relaxed = Quat(Eigen::AngleAxisd(flexion - skeleton_.joints[j].zero[0],
                                         skeleton_.joints[j].axes.col(0)));
    }
  }
}

PoseTransfer::FileTurn PoseTransfer::file_turn(const std::string& part) const {
  return {mapping_.rotation_joint.at(part), alignment_.W, alignment_.from_source.at(part)};
}

void PoseTransfer::plan_sides() {
  thorax_ = ours("thorax");
  hips_from_root_ = 0.5 * (rest_[ours("hip_l")] + rest_[ours("hip_r")]) - rest_[0];
  std::size_t l = 0;
  for (const auto& [upper, middle, lower] :
       {std::array<const char*, 3>{"shoulder", "elbow", "wrist"}, {"hip", "knee", "ankle"}})
    for (const std::string s : kSides) {
      Limb& limb = limbs_[l++];
      limb.upper = file_turn(upper + s);
      limb.lower = file_turn(middle + s);
      limb.rest_upper = rest_[ours(middle + s)] - rest_[ours(upper + s)];
      limb.rest_lower = rest_[ours(lower + s)] - rest_[ours(middle + s)];
      limb.hinge = skeleton_.joints[ours(middle + s)].axes.col(0);
    }
  for (std::size_t side = 0; side < 2; ++side) {
    const std::string s = kSides[side];
    SidePlan& here = sides_[side];
    here.elbow = file_turn("elbow" + s);
    here.wrist = has("wrist" + s) ? file_turn("wrist" + s) : here.elbow;
    here.ankle = file_turn("ankle" + s);
    here.arm = limbs_[side].rest_upper;
    here.scapula = rest_[ours("scapula" + s)];
    here.wrist_at = rest_[ours("wrist" + s)];
    here.hip = mapping_.position_joint.at("hip" + s);
    here.foot = mapping_.position_joint.at("ankle" + s);
    if (matching_rig_ == nullptr) continue;
    const auto point_of = [&](int joint) {
      const auto at = std::ranges::find_if(matching_rig_->points, [&](const MatchedPoint& point) {
        return point.joint == joint && point.part == joint;
      });
      return at == matching_rig_->points.end() ? nullptr : &*at;
    };
    here.rig_hip = point_of(ours("hip" + s));
    here.rig_ankle = point_of(ours("ankle" + s));
  }
  for (std::size_t j = 0; j < plans_.size(); ++j) {
    Plan& plan = plans_[j];
    plan.side = side_index(side_of(skeleton_.joints[j].name));
    if (!plan.part.empty()) plan.turn = file_turn(plan.part);
    for (std::size_t k = 0; k < limbs_.size(); ++k)
      if (plan.part == (k < 2 ? "shoulder" : "hip") + std::string(kSides[k % 2]))
        plan.limb = int(k);
  }
}

// At fraction plan.bending of the chain as to where it points, at plan.turning as to its twist.
Mat3 PoseTransfer::spread(const std::vector<Knot>& knots, const Plan& plan) const {
  const auto along = [&](double s) {
    std::size_t k = 1;
    while (k + 1 < knots.size() && knots[k].s < s) ++k;
    const double span = knots[k].s - knots[k - 1].s;
    const double t = span > 1e-9 ? std::clamp((s - knots[k - 1].s) / span, 0.0, 1.0) : 1;
    return knots[k - 1].now.slerp(t, knots[k].now);
  };
  const Quat base = along(0);
  const Quat bent = base.conjugate() * along(plan.bending),
             turned = base.conjugate() * along(plan.turning);
  const Quat swing = bent * twist_of(bent, Vec3::UnitY()).conjugate();
  return (base * swing * twist_of(turned, Vec3::UnitY())).toRotationMatrix();
}

// Elbow and knee bend about one axis: where they are bent, upper arm and thigh are rotated about
// their length so that the hinge takes the lower bone to where it is in the file. Neither bone need
// be perpendicular to the hinge: a forearm of ours bears outwards. What that takes beyond a hinge
// across both bones is damped for small bends, where a large turn gains little. Straight limbs keep
// the file's rotation.
void PoseTransfer::limb_rotations(const std::vector<Transform>& X) {
  for (Limb& limb : limbs_) {
    Mat3& R = limb.R = limb.upper.in(X);
    const Mat3 L = limb.lower.in(X);
    const Vec3 a = (R * limb.rest_upper).normalized(), b = (L * limb.rest_lower).normalized();
    const Vec3 hinge = R * limb.hinge, wanted = a.cross(b);
    const Vec3 h = hinge - a.dot(hinge) * a;
    if (alignment_.same_rest || h.norm() <= 0.5) continue;
    const double angle = std::atan2(a.dot(h.cross(wanted)), h.dot(wanted));
    // The hinge leans on both bones at rest as it does now.
    const double lean = limb.rest_lower.normalized().dot(limb.hinge) - a.dot(hinge) * a.dot(b),
                 sine = wanted.norm();
    const double more = sine * lean / (h.norm() * (sine * sine + kLean * kLean));
    // More than 60 deg is a limb bent the wrong way, which is left to the report.
    const double share = smooth_step(std::sin(4 * kDegree), std::sin(20 * kDegree), sine) *
                         (1 - smooth_step(50 * kDegree, 70 * kDegree, std::abs(angle)));
    // A hinge across both bones comes towards the lower one by a turn backwards about the upper.
    R = Eigen::AngleAxisd(share * (angle - more), a).toRotationMatrix() * R;
  }
}

Mat3 PoseTransfer::rotate_joint(const std::vector<Transform>& X, int j) const {
  const Plan& plan = plans_[j];
  const Joint& joint = skeleton_.joints[j];
  const Mat3 parent = joint.parent < 0 ? Mat3(Mat3::Identity()) : R_[joint.parent];
  const SidePlan& side = sides_[plan.side];
  auto girdle = [&] {
    return girdle_rhythm(plan.side == 0 ? Side::left : Side::right, side.arm,
                         R_[thorax_].transpose() * limbs_[plan.side].R * side.arm);
  };
  switch (plan.rule) {
    case Rule::collar: {
      // A collar bone of the file may carry all motion of the shoulder: its long axis is followed
      // within the range of a real one.
      const Quat turn(Mat3(parent.transpose() * plan.turn.in(X)));
      const Vec3 along_bone = (side.scapula - rest_[j]).normalized();
      const Eigen::AngleAxisd swing(Quat::FromTwoVectors(along_bone, turn * along_bone));
      return parent *
             Eigen::AngleAxisd(soft_limit(swing.angle(), 15 * kDegree, 30 * kDegree), swing.axis())
                 .toRotationMatrix();
    }
    case Rule::direct:
      return plan.limb >= 0 ? limbs_[std::size_t(plan.limb)].R : plan.turn.in(X);
    case Rule::spine:
      return spread(spine_knots_, plan);
    case Rule::neck:
      return spread(neck_knots_, plan);
    case Rule::clavicle:
      return parent * girdle().clavicle.toRotationMatrix();
    case Rule::scapula: {
      // The file's collar bone may move by itself: the scapula keeps the rhythm's rotation relative
      // to the clavicle.
      const Girdle g = girdle();
      return parent * (g.clavicle.conjugate() * g.scapula).toRotationMatrix();
    }
    case Rule::blade: {
      // Half of it is the rhythm's, half the collar's own.
      const Quat by_rhythm(Mat3(R_[thorax_] * girdle().scapula.toRotationMatrix()));
      return by_rhythm.slerp(0.5, Quat(plan.turn.in(X))).toRotationMatrix();
    }
    case Rule::elbow: {
      // The ulna only bends; the axial rotation of the file's forearm goes to the radius.
      // It bends about its hinge, which the forearm need not be perpendicular to; what is left over
      // is for the limits.
      const Vec3 along = limbs_[plan.side].rest_lower.normalized(),
                 wanted = parent.transpose() * side.elbow.in(X)*along;
      const Vec3 hinge = joint.axes.col(0);
      const double bend =
          alignment_.same_rest
              ? 0
              : std::atan2(hinge.dot(along.cross(wanted)),
                           along.dot(wanted) - hinge.dot(along) * hinge.dot(wanted));
      const Mat3 bent = Eigen::AngleAxisd(bend, hinge).toRotationMatrix();
      return parent * Quat::FromTwoVectors(bent * along, wanted).toRotationMatrix() * bent;
    }
    case Rule::forearm: {
      if (alignment_.same_rest) return side.elbow.in(X);
      const Vec3 along = (side.wrist_at - rest_[j]).normalized();
      return parent *
             twist_of(Quat(Mat3(parent.transpose() * side.wrist.in(X))), along).toRotationMatrix();
    }
    case Rule::ankle: {
      // The ankle takes the rotation about its own axis, the subtalar joint the rest.
      const Quat foot(Mat3(parent.transpose() * side.ankle.in(X)));
      return parent * twist_of(foot, joint.axes.col(0)).toRotationMatrix();
    }
    case Rule::subtalar:
      return side.ankle.in(X);
    case Rule::finger:
    case Rule::follow:
      return parent * plan.still;
  }
  return parent;
}

void PoseTransfer::transfer(const std::vector<Transform>& X, Pose& pose) {
  limb_rotations(X);
  for (std::vector<Knot>* knots : {&spine_knots_, &neck_knots_})
    for (Knot& knot : *knots) knot.now = Quat(knot.turn.in(X));
  pose.rotations.resize(skeleton_.joints.size());
  for (size_t j = 0; j < skeleton_.joints.size(); ++j) {
    R_[j] = rotate_joint(X, int(j));
    const int parent = skeleton_.joints[j].parent;
    // The foot keeps its rotation from the file, since standing soles are conspicuous.
    const Rule rule = plans_[j].rule;
    if (parent >= 0 && !alignment_.same_rest && rule != Rule::subtalar && rule != Rule::ankle &&
        rule != Rule::finger && rule != Rule::follow)
      R_[j] = R_[parent] * without_locked_axes(skeleton_.joints[j], zeros_[j],
                                               Quat(Mat3(R_[parent].transpose() * R_[j])))
                               .toRotationMatrix();
  }
  if (matching_rig_) {
    for (const MatchedChain& chain : matching_rig_->chains)
      bend_to_rig(*matching_rig_, chain, X, rest_, R_);
    for (const MatchedCollar& collar : matching_rig_->collars)
      reach_with_collar(*matching_rig_, collar, X, rest_, R_);
  }
  for (size_t j = 0; j < skeleton_.joints.size(); ++j) {
    const int parent = skeleton_.joints[j].parent;
    pose.rotations[j] =
        Quat(parent < 0 ? R_[j] : Mat3(R_[parent].transpose() * R_[j])).normalized();
  }
  const Vec3 hips = 0.5 * (X[std::size_t(sides_[0].hip)].translation() +
                           X[std::size_t(sides_[1].hip)].translation());
  pose.root = scale_ * (alignment_.W * hips) - R_[0] * hips_from_root_;
  if (!mapping_.ours) complete_pose(skeleton_, pose);
  if (!matching_rig_) return;
  forward_kinematics(skeleton_, pose, X_WJ_);
  pose.root += shift_to_rig(*matching_rig_, X, rest_, X_WJ_);
}

Vec3 PoseTransfer::file_place(const std::vector<Transform>& X, int joint,
                              const MatchedPoint* point) const {
  if (point != nullptr) return file_position(*matching_rig_, X, *point);
  return scale_ * (alignment_.W * X[std::size_t(joint)].translation());
}

}  // namespace ecorche::inline v1
