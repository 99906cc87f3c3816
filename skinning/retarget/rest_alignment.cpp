#include "skinning/retarget/rest_alignment.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "anatomy/compute/angle_between.h"
#include "anatomy/errors.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kAdultLeg = 0.85;  // hip to ankle, m
constexpr int kSampledFrames = 400;
constexpr std::array<const char*, 2> kSidesRestAlignment = {"_l", "_r"};

using Frames = std::vector<Transform>;  // #file joints

double degrees(double d) { return d * kDegree; }

// Of a direction over the ground: 0 forwards (+Z), positive to the left.
double heading(const Vec3& v) { return std::atan2(v.x(), v.z()); }

// The file's figure in one pose.
struct Figure {
  const MotionClip& source;
  const JointMapping& mapping;
  const Frames& X;

  bool has(const std::string& part) const { return mapping.position_joint.count(part) > 0; }
  Vec3 at(const std::string& part) const {
    return X[mapping.position_joint.at(part)].translation();
  }
  Mat3 turn(const std::string& part) const { return X[mapping.rotation_joint.at(part)].linear(); }
  Vec3 hips() const { return 0.5 * (at("hip_l") + at("hip_r")); }
  Vec3 feet() const { return 0.5 * (at("ankle_l") + at("ankle_r")); }
  Vec3 end_of(const std::string& part) const {
    Vec3 offset;
    const int joint = mapping.rotation_joint.at(part);
    return bone_end(source, joint, offset) ? Vec3(X[joint] * offset) : X[joint].translation();
  }
  Vec3 bone(const std::string& from, const std::string& to) const { return at(to) - at(from); }
  Vec3 forearm(const std::string& s) const {
    return has("wrist" + s) ? bone("elbow" + s, "wrist" + s)
                            : Vec3(end_of("elbow" + s) - at("elbow" + s));
  }
  Vec3 hand(const std::string& s) const {
    Vec3 knuckles = Vec3::Zero();
    int count = 0;
    for (const char* part : {"mcp2", "mcp3", "mcp4", "mcp5", "fingers"})
      if (has(part + s)) knuckles += at(part + s), ++count;
    const Vec3 end = count > 0          ? Vec3(knuckles / count)
                     : has("wrist" + s) ? end_of("wrist" + s)
                                        : Vec3(at("elbow" + s) + forearm(s));
    return end - (has("wrist" + s) ? at("wrist" + s) : end);
  }
  // Towards the thumb's side of the hand; zero where the file does not tell.
  Vec3 radial(const std::string& s) const {
    if (has("mcp2" + s) && has("mcp5" + s)) return at("mcp2" + s) - at("mcp5" + s);
    return Vec3::Zero();
  }
  Vec3 thumb(const std::string& s) const {
    if (!has("cmc1" + s)) return Vec3::Zero();
    return end_of("cmc1" + s) - at("wrist" + s);
  }
  Vec3 foot(const std::string& s) const {
    for (const char* part : {"toes", "mtp3", "mtp2", "mtp1"})
      if (has(part + s)) return bone("ankle" + s, part + s);
    return end_of("ankle" + s) - at("ankle" + s);
  }
  double leg() const {
    double sum = 0;
    for (const std::string s : kSidesRestAlignment)
      sum += bone("hip" + s, "knee" + s).norm() + bone("knee" + s, "ankle" + s).norm();
    return sum / 2;
  }
};

// Our figure at rest.
struct OurRest {
  const Skeleton& skeleton;
  std::vector<Vec3> positions;
  explicit OurRest(const Skeleton& s) : skeleton(s), positions(rest_positions(s)) {}

  Vec3 at(const std::string& name) const { return positions[joint_of(skeleton, name)]; }
  Vec3 bone(const std::string& from, const std::string& to) const { return at(to) - at(from); }
  Vec3 hand(const std::string& s) const {
    return 0.25 * (at("mcp2" + s) + at("mcp3" + s) + at("mcp4" + s) + at("mcp5" + s)) -
           at("wrist" + s);
  }
  Vec3 foot(const std::string& s) const {
    return 0.5 * (at("mtp2" + s) + at("mtp3" + s)) - at("ankle" + s);
  }
  // Axis about which the joint flexes: as stored when it agrees with the bend of the rest pose,
  // else that bend's normal.
  Vec3 hinge(const std::string& middle, const Vec3& upper, const Vec3& lower) const {
    const Vec3 bend = upper.cross(lower);
    const Vec3 stored = skeleton.joints[find_joint(skeleton, middle)].axes.col(0);
    const bool bent = bend.norm() > std::sin(degrees(15)) * upper.norm() * lower.norm();
    return bent && bend.normalized().dot(stored) < std::cos(degrees(45)) ? Vec3(bend.normalized())
                                                                         : stored;
  }
};

// The axis (0..2) and sign that a direction is nearest to.
std::pair<int, double> nearest_axis(const Vec3& direction) {
  int axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return {axis, direction[axis] < 0 ? -1.0 : 1.0};
}

Vec3 snapped(const Vec3& direction, double within) {
  const auto [axis, sign] = nearest_axis(direction);
  const Vec3 unit = sign * Vec3::Unit(axis);
  return angle_between(direction, unit) < within ? unit : Vec3(direction.normalized());
}

std::string axis_name(const Vec3& direction) {
  const auto [axis, sign] = nearest_axis(direction);
  return fmt::format("{}{}", sign < 0 ? '-' : '+', "xyz"[axis]);
}

// Rows: left, up, forward.
Mat3 axes_from(const Vec3& left, const Vec3& up) {
  Mat3 W;
  W.row(1) = up.normalized();
  W.row(0) = (left - left.dot(W.row(1)) * W.row(1).transpose()).normalized();
  W.row(2) = W.row(0).cross(W.row(1));
  return W;
}

// Is this pose a person standing upright, with legs and trunk in line and both arms alike?
double standing_cost(const Figure& figure, const Vec3& up) {
  double cost = 0;
  auto off = [&](const Vec3& v, const Vec3& wanted) {
    return v.norm() > 0 ? 1 - v.normalized().dot(wanted) : 0.5;
  };
  for (const std::string s : kSidesRestAlignment) {
    cost += off(figure.bone("hip" + s, "knee" + s), -up) +
            off(figure.bone("knee" + s, "ankle" + s), -up);
    cost += 0.2 * off(figure.bone("shoulder" + s, "elbow" + s), figure.forearm(s).normalized());
  }
  cost += 2 * off(figure.at("head") - figure.hips(), up);
  const Vec3 left = (figure.at("hip_l") - figure.at("hip_r")).normalized();
  const Vec3 arm_l = figure.bone("shoulder_l", "elbow_l").normalized(),
             arm_r = figure.bone("shoulder_r", "elbow_r").normalized();
  cost += 0.5 * off(arm_l, arm_r - 2 * arm_r.dot(left) * left);
  return cost;
}

Mat3 rotation_between(const Vec3& from, const Vec3& to) {
  return Quat::FromTwoVectors(from, to).toRotationMatrix();
}

// Rotates C about the bone's direction so that `axis`, rotated by C, comes nearest to `wanted`; not
// at all where that is zero, which tells nothing.
Mat3 twist_onto(const Mat3& C, const Vec3& direction, const Vec3& axis, const Vec3& wanted) {
  const Vec3 d = direction.normalized();
  const Vec3 a = C * axis - d.dot(C * axis) * d, w = wanted - d.dot(wanted) * d;
  if (a.norm() < 0.1 || !(w.norm() > 0.1 * wanted.norm())) return C;
  return Eigen::AngleAxisd(std::atan2(d.dot(a.cross(w)), a.dot(w)), d).toRotationMatrix() * C;
}

// Frame of a hand: along the metacarpals, towards the thumb.
Mat3 hand_frame(const Vec3& along, const Vec3& towards_thumb) {
  Mat3 F;
  F.col(0) = along.normalized();
  F.col(1) = (towards_thumb - towards_thumb.dot(F.col(0)) * F.col(0)).normalized();
  F.col(2) = F.col(0).cross(F.col(1));
  return F;
}

class Aligner {
 public:
  Aligner(const MotionClip& source, const JointMapping& mapping, const Skeleton& ours)
      : source_(source), mapping_(mapping), ours_(ours) {
    clip_kinematics(source, -1, rest_);
    const int step = std::max(1, source.frame_count / kSampledFrames);
    for (int f = 0; f < source.frame_count; f += step) {
      sampled_.emplace_back();
      sample_frame_.push_back(f);
      clip_kinematics(source, f, sampled_.back());
    }
  }

  RestAlignment align(const std::optional<char>& up) {
    RestAlignment out;
    out.leg = figure(rest_).leg();
    if (!(out.leg > 0)) throw UnfitError(source_.name + ": the legs have no length");
    find_axes(up, out);
    out.same_rest = out.reference_frame < 0 && limbs_agree();
    if (out.same_rest) {
      for (const char* part : {"pelvis", "thorax"}) C_[part] = Mat3::Identity();
      for (const auto& [name, joint] : mapping_.rotation_joint) C_[name] = Mat3::Identity();
    } else {
      pose_rest(out.reference_frame >= 0);
      level_feet(out.W);
    }
    for (int joint : mapping_.spine) out.trunk[joint] = from_source(joint, C_["thorax"]);
    for (int joint : mapping_.neck) out.trunk[joint] = from_source(joint, C_["thorax"]);
    for (const auto& [name, joint] : mapping_.rotation_joint) {
      const auto found = C_.find(name);
      const Mat3 C = found != C_.end() ? found->second : Mat3(C_["pelvis"]);
      out.from_source[name] = from_source(joint, C);
    }
    return out;
  }

 private:
  Figure figure(const Frames& X) const { return Figure{source_, mapping_, X}; }
  const Frames& reference() const { return *reference_; }
  Mat3 from_source(int joint, const Mat3& C) const {
    return reference()[joint].linear().transpose() * W_ref_.transpose() * C;
  }

  // Up of the movement, up and facing of the rest pose, and which pose the alignment can start
  // from.
  void find_axes(const std::optional<char>& given_up, RestAlignment& out) {
    const Figure rest = figure(rest_);
    Vec3 moving_up = Vec3::Zero();
    for (const Frames& X : sampled_)
      moving_up += (figure(X).at("head") - figure(X).feet()).normalized();
    const Vec3 rest_up = (rest.at("head") - rest.feet()).normalized();
    const bool lying = sampled_.empty() || moving_up.norm() < 0.5 * sampled_.size() ||
                       moving_up.cwiseAbs().maxCoeff() < 0.8 * moving_up.norm();
    if (lying && !sampled_.empty())
      out.warnings.push_back("the figure is seldom upright; up is taken from the rest pose");
    const Vec3 up_of_rest = snapped(rest_up, degrees(30));
    const Vec3 left = rest.at("hip_l") - rest.at("hip_r");
    const bool rest_stands =
        standing_cost(rest, up_of_rest) < 1.0 && angle_between(left, up_of_rest) > degrees(60);
    Vec3 up = snapped(lying ? rest_up : moving_up, 4);
    // A file with our own joint names was written by us, in axes that its rest pose tells.
    if (!lying && rest_stands && (mapping_.ours || is_ground(up_of_rest, up))) up = up_of_rest;
    if (given_up && !lying && nearest_axis(up).first != *given_up - 'x')
      throw UnfitError(
          fmt::format("{}: --up {}: the figure stands along {}; leave --up out, or name that axis",
                      source_.name, *given_up, "xyz"[nearest_axis(up).first]));
    if (given_up)
      up = Vec3::Unit(*given_up - 'x') * (moving_up[*given_up - 'x'] < 0 && !lying ? -1.0 : 1.0);
    out.up = "xyz"[nearest_axis(up).first];

    if (rest_stands) {
      Vec3 level = left - left.dot(up_of_rest) * up_of_rest;
      W_ref_ = axes_from(snapped(level, degrees(20)), up_of_rest);
      out.W =
          angle_between(up, up_of_rest) < degrees(5) ? W_ref_ : rotation_between(up, Vec3::UnitY());
      reference_ = &rest_;
    } else {
      if (sampled_.empty())
        throw UnfitError(
            source_.name +
            ": the rest pose is not a standing person and there are no frames to find one in");
      size_t best = 0;
      std::vector<double> cost(sampled_.size());
      for (size_t k = 0; k < sampled_.size(); ++k) cost[k] = standing_cost(figure(sampled_[k]), up);
      for (size_t k = 0; k < cost.size(); ++k)
        if (cost[k] < cost[best]) best = k;
      reference_ = &sampled_[best];
      out.reference_frame = sample_frame_[best];
      out.W = W_ref_ = rotation_between(up, Vec3::UnitY());
      out.warnings.push_back(
          fmt::format("the rest pose is not a standing person; frame {} is used in its place",
                      out.reference_frame));
    }
    out.facing = axis_name(W_ref_.transpose() * facing());
    check_handedness(out);
  }

  // Who crawls or lies on his front with the head ahead looks like one who stands, along another
  // axis. The rest pose's up is right where the lowest point of most frames is at nought along it,
  // as files have their ground, and far from nought along the other one.
  bool is_ground(const Vec3& up_of_rest, const Vec3& other) const {
    constexpr double kOnGround = 0.15, kTimes = 2;  // of the leg's length
    if (angle_between(up_of_rest, other) < degrees(45)) return false;
    double by_rest = 0, by_other = 0;
    for (const Frames& X : sampled_) {
      double low = HUGE_VAL, other_low = HUGE_VAL;
      for (const auto& [part, joint] : mapping_.position_joint) {
        low = std::min(low, up_of_rest.dot(X[std::size_t(joint)].translation()));
        other_low = std::min(other_low, other.dot(X[std::size_t(joint)].translation()));
      }
      by_rest += std::abs(low);
      by_other += std::abs(other_low);
    }
    return by_rest < kOnGround * figure(rest_).leg() * double(sampled_.size()) &&
           kTimes * by_rest < by_other;
  }

  // Level direction the reference figure faces, our axes.
  Vec3 facing() const {
    const Figure f = figure(reference());
    const Vec3 left = W_ref_ * (f.at("hip_l") - f.at("hip_r"));
    return Vec3(left.x(), 0, left.z()).cross(Vec3::UnitY()).normalized();
  }

  void check_handedness(RestAlignment& out) const {
    const Figure f = figure(reference());
    const Vec3 toes = W_ref_ * (f.foot("_l") + f.foot("_r"));
    if (Vec3(toes.x(), 0, toes.z()).norm() > 0.05 * f.leg() && toes.dot(facing()) < 0)
      out.warnings.push_back(
          "the toes point backwards: left and right are swapped, or the file is mirrored");
  }

  // Do the four limbs lie at rest as ours do?
  bool limbs_agree() const {
    const Figure f = figure(reference());
    for (const std::string s : kSidesRestAlignment) {
      const std::array<std::pair<Vec3, Vec3>, 4> bones = {
          {{f.bone("shoulder" + s, "elbow" + s), ours_.bone("shoulder" + s, "elbow" + s)},
           {f.forearm(s), ours_.bone("elbow" + s, "wrist" + s)},
           {f.bone("hip" + s, "knee" + s), ours_.bone("hip" + s, "knee" + s)},
           {f.bone("knee" + s, "ankle" + s), ours_.bone("knee" + s, "ankle" + s)}}};
      for (const auto& [theirs, own] : bones)
        if (angle_between(W_ref_ * theirs, own) > degrees(12)) return false;
    }
    return true;
  }

  // Fills C_: the rotations that put our figure into the reference pose.
  void pose_rest(bool from_frame) {
    const Vec3 forward = facing();
    C_["pelvis"] =
        Eigen::AngleAxisd(std::atan2(forward.x(), forward.z()), Vec3::UnitY()).toRotationMatrix();
    // A standing rest pose is upright for both; a captured frame leans, so its trunk is measured.
    C_["thorax"] = from_frame ? Mat3(trunk_lean() * C_["pelvis"]) : C_["pelvis"];
    for (const char* part : {"head", "jaw"}) C_[part] = C_["thorax"];
    for (const std::string s : kSidesRestAlignment) {
      for (const char* part : {"clavicle", "scapula"}) C_[part + s] = C_["thorax"];
      pose_arm(s);
      pose_leg(s);
    }
  }

  Mat3 trunk_lean() const {
    const Figure f = figure(reference());
    const Vec3 theirs = W_ref_ * (0.5 * (f.at("shoulder_l") + f.at("shoulder_r")) - f.hips());
    const Vec3 own = 0.5 * (ours_.at("shoulder_l") + ours_.at("shoulder_r")) -
                     0.5 * (ours_.at("hip_l") + ours_.at("hip_r"));
    return rotation_between(C_.at("pelvis") * own, theirs);
  }

  void pose_arm(const std::string& s) {
    const Figure f = figure(reference());
    const Vec3 upper = W_ref_ * f.bone("shoulder" + s, "elbow" + s), lower = W_ref_ * f.forearm(s);
    const Vec3 our_upper = ours_.bone("shoulder" + s, "elbow" + s),
               our_lower = ours_.bone("elbow" + s, "wrist" + s);
    Mat3 C = rotation_between(C_["thorax"] * our_upper, upper) * C_["thorax"];
    C = twist_onto(C, upper, ours_.hinge("elbow" + s, our_upper, our_lower),
                   measured_hinge("shoulder" + s, "elbow" + s, s));
    C_["shoulder" + s] = C;
    C = rotation_between(C * our_lower, lower) * C;
    C_["elbow" + s] = C_["forearm" + s] = C;
    pose_hand(s, C);
  }

  void pose_hand(const std::string& s, Mat3 C) {
    const Figure f = figure(reference());
    const Vec3 along = W_ref_ * f.hand(s), our_along = ours_.hand(s);
    const Vec3 radial = W_ref_ * f.radial(s), thumb = W_ref_ * f.thumb(s);
    if (along.norm() > 1e-3 * f.leg()) {
      if (radial.norm() > 0 && radial.cross(along).norm() > 0.1 * radial.norm() * along.norm())
        C = hand_frame(along, radial) *
            hand_frame(our_along, ours_.bone("mcp5" + s, "mcp2" + s)).transpose();
      else if (thumb.norm() > 0 && thumb.cross(along).norm() > 0.3 * thumb.norm() * along.norm())
        C = hand_frame(along, thumb) *
            hand_frame(our_along, ours_.bone("wrist" + s, "mcp1" + s)).transpose();
      else
        C = rotation_between(C * our_along, along) * C;
    }
    C_["wrist" + s] = C;
    static constexpr std::array<std::array<const char*, 3>, 5> kDigits = {
        {{"cmc1", "mcp1", "ip1"},
         {"mcp2", "pip2", "dip2"},
         {"mcp3", "pip3", "dip3"},
         {"mcp4", "pip4", "dip4"},
         {"mcp5", "pip5", "dip5"}}};
    for (const auto& digit : kDigits) {
      Mat3 D = C;
      for (int k = 0; k < 3; ++k) {
        const std::string part = digit[k] + s;
        if (!f.has(part)) break;
        const bool last = k == 2;
        const Vec3 theirs =
            W_ref_ * (last || !f.has(digit[k + 1] + s) ? f.end_of(part) - f.at(part)
                                                       : f.bone(part, digit[k + 1] + s));
        const Vec3 own =
            last ? ours_.bone(digit[k - 1] + s, part) : ours_.bone(part, digit[k + 1] + s);
        // an End Site that points back is none
        const bool folded = last && theirs.dot(D * own) < 0;
        if (theirs.norm() > 0 && !folded) D = rotation_between(D * own, theirs) * D;
        C_[part] = D;
      }
    }
  }

  void pose_leg(const std::string& s) {
    const Figure f = figure(reference());
    const Vec3 upper = W_ref_ * f.bone("hip" + s, "knee" + s),
               lower = W_ref_ * f.bone("knee" + s, "ankle" + s);
    const Vec3 our_upper = ours_.bone("hip" + s, "knee" + s),
               our_lower = ours_.bone("knee" + s, "ankle" + s);
    Mat3 C = rotation_between(C_["pelvis"] * our_upper, upper) * C_["pelvis"];
    C = twist_onto(C, upper, ours_.hinge("knee" + s, our_upper, our_lower),
                   measured_hinge("hip" + s, "knee" + s, s));
    C_["hip" + s] = C;
    C = rotation_between(C * our_lower, lower) * C;
    // Soles are level in both rest poses; only the toes' heading may differ. How far toes point
    // away from the knee's plane is a body's own (the shin's torsion): the shin turns a little
    // towards the file's heading, the ankle not at all.
    const Vec3 foot = W_ref_ * f.foot(s), our_foot = C_["pelvis"] * ours_.foot(s),
               natural = C * ours_.foot(s);
    Mat3 yaw = Mat3::Identity();
    if (std::hypot(foot.x(), foot.z()) > 0.05 * f.leg()) {
      constexpr double kShin = 3 * kDegree;
      const double shin =
          std::clamp(std::remainder(heading(foot) - heading(natural), 2 * kPi), -kShin, kShin);
      C = Eigen::AngleAxisd(shin, -lower.normalized()).toRotationMatrix() * C;
      yaw = Eigen::AngleAxisd(heading(natural) + shin - heading(our_foot), Vec3::UnitY());
    }
    C_["knee" + s] = C;
    const Mat3 level = yaw * C_["pelvis"];
    for (const char* part : {"ankle", "subtalar", "toes"}) C_[part + s] = level;
    for (const auto& [name, joint] : mapping_.rotation_joint)
      if (name.ends_with(s) && (name.starts_with("mtp") || name.starts_with("toe")))
        C_[name] = level;
  }

  // Soles that are not level while the foot stands were not level in the reference pose either: the
  // median of the standing frames puts them right.
  void level_feet(const Mat3& W) {
    for (const std::string s : kSidesRestAlignment) {
      std::vector<double> heights;
      for (const Frames& X : sampled_) heights.push_back((W * figure(X).at("ankle" + s)).y());
      if (heights.size() < 20) return;
      std::vector<double> sorted = heights;
      std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 10, sorted.end());
      const double low = sorted[sorted.size() / 10] + 0.02 * figure(rest_).leg() / kAdultLeg;
      std::array<std::vector<double>, 2>
          tilt;  // of the sole's normal, seen in the foot's rest axes: x, z
      const Mat3 A = from_source(mapping_.rotation_joint.at("ankle" + s), C_["ankle" + s]);
      for (size_t k = 0; k < sampled_.size(); ++k) {
        if (heights[k] > low) continue;
        const Vec3 up = (W * figure(sampled_[k]).turn("ankle" + s) * A).transpose() * Vec3::UnitY();
        tilt[0].push_back(up.x());
        tilt[1].push_back(up.z());
      }
      Vec3 up = Vec3::UnitY();
      for (int axis : {0, 1}) {
        std::nth_element(tilt[axis].begin(), tilt[axis].begin() + tilt[axis].size() / 2,
                         tilt[axis].end());
        up[2 * axis] = tilt[axis][tilt[axis].size() / 2];
      }
      const double angle = angle_between(up, Vec3::UnitY());
      if (angle < degrees(3) || angle > degrees(35)) continue;
      const Mat3 level = rotation_between(Vec3::UnitY(), up);
      for (auto& [name, C] : C_)
        if (name.ends_with(s) && (name.starts_with("ankle") || name.starts_with("subtalar") ||
                                  name.starts_with("mtp") || name.starts_with("toe")))
          C = C * level;
    }
  }

  // The axis the middle joint flexes about, carried by the upper bone in the reference pose, our
  // axes; zero if it hardly bends or not about one axis.
  Vec3 measured_hinge(const std::string& upper, const std::string& middle,
                      const std::string& s) const {
    Vec3 sum = Vec3::Zero();
    double total = 0;
    int bent = 0;
    for (const Frames& X : sampled_) {
      const Figure f = figure(X);
      const Vec3 a = f.bone(upper, middle),
                 b = middle.starts_with("knee") ? f.bone(middle, "ankle" + s) : f.forearm(s);
      const Vec3 axis = f.turn(upper).transpose() * a.normalized().cross(b.normalized());
      sum += axis * axis.norm();
      total += axis.squaredNorm();
      bent += axis.norm() > std::sin(degrees(25)) || a.dot(b) < 0;
    }
    if (bent < 5 || 20 * bent < int(sampled_.size()) || sum.norm() < 0.9 * total)
      return Vec3::Zero();
    return W_ref_ * figure(reference()).turn(upper) * sum.normalized();
  }

  const MotionClip& source_;
  const JointMapping& mapping_;
  OurRest ours_;
  Frames rest_;
  std::vector<Frames> sampled_;
  std::vector<int> sample_frame_;
  const Frames* reference_ = nullptr;
  Mat3 W_ref_ = Mat3::Identity();
  std::map<std::string, Mat3> C_;
};

}  // namespace

RestAlignment align_rest(const MotionClip& source, const JointMapping& mapping,
                         const Skeleton& ours, const std::optional<char>& up) {
  return Aligner(source, mapping, ours).align(up);
}

std::pair<std::string, double> guess_unit(double leg) {
  static constexpr std::array<std::pair<const char*, double>, 7> kUnits = {{{"m", 1},
                                                                            {"dm", 0.1},
                                                                            {"CMU unit", 2.54 / 45},
                                                                            {"inch", 0.0254},
                                                                            {"cm", 0.01},
                                                                            {"mm", 0.001},
                                                                            {"foot", 0.3048}}};
  std::pair<std::string, double> best = {"unknown", kAdultLeg / leg};
  double nearest = std::log(1.3);  // children's and giants' legs, 0.65 to 1.10 m
  for (const auto& [name, metres] : kUnits)
    if (const double off = std::abs(std::log(leg * metres / kAdultLeg)); off < nearest)
      nearest = off, best = {name, metres};
  return best;
}

}  // namespace ecorche::inline v1
