#include "app/studio/handles/limit_arcs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/joint_angles.h"
#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

constexpr double kLongest = 0.17, kShortest = 0.03, kTurnRadius = 0.07;  // m
constexpr double kFixed = 2;      // deg; what moves less is no movement
constexpr int kWay = 100;         // deg on either side of a limit that a drag looks at
constexpr double kMostArc = 2.5;  // deg from one point of an arc to the next

// From the joint along its bone, at rest: to the farthest joint that hangs on it, or where that is
// near (the forearm's turn beside the elbow), to the next.
Vec3 bone_arm(const Skeleton& skeleton, int joint) {
  constexpr double near = 0.08;  // m
  Vec3 best = Vec3::Zero();
  for (int c = 0; c < int(skeleton.joints.size()); ++c) {
    const Joint& child = skeleton.joints[std::size_t(c)];
    if (child.parent != joint) continue;
    Vec3 arm = child.X_PJ.translation();
    for (const Joint& next : skeleton.joints)
      if (next.parent == c && child.X_PJ.translation().norm() < near &&
          (child.X_PJ.translation() + next.X_PJ.translation()).norm() > arm.norm())
        arm = child.X_PJ.translation() + next.X_PJ.translation();
    if (arm.norm() > best.norm()) best = arm;
  }
  if (best.norm() > 1e-3) return best;
  return kShortest * skeleton.joints[std::size_t(joint)].axes.col(2);
}

// Where the tip of `arm` is with these angles.
struct Sweep {
  Joint joint;
  Mat3 parent;
  Vec3 middle, arm;

  Vec3 tip(const Vec3& angles) const {
    return middle + parent * (joint_rotation(joint, angles) * arm);
  }
};

std::pair<double, double> limits_of(const Document& seen, const Joint& joint, int axis) {
  for (const std::string& name : {joint.name, split_side(joint.name).first}) {
    const auto edit = seen.joints->find(name);
    if (edit != seen.joints->end() && edit->second.limits[axis]) return *edit->second.limits[axis];
  }
  return {joint.min[axis] / kDegree, joint.max[axis] / kDegree};
}

}  // namespace

std::vector<LimitArc> limit_arcs(const Skeleton& skeleton, const Document& seen, int joint,
                                 const PosedAnatomy& posed, std::vector<Handle>& handles) {
  std::vector<LimitArc> out;
  Sweep sweep;
  sweep.joint = skeleton.joints[std::size_t(joint)];
  if (sweep.joint.parent < 0) return out;
  sweep.parent = posed.X_WJ[std::size_t(sweep.joint.parent)].linear();
  sweep.middle = posed.X_WJ[std::size_t(joint)].translation();
  const Quat local(sweep.parent.transpose() * posed.X_WJ[std::size_t(joint)].linear());
  const Vec3 now = joint_angles_near_limits(sweep.joint, local);
  const Vec3 bone = bone_arm(skeleton, joint);
  const double length = std::clamp(0.6 * bone.norm(), kShortest, kLongest);
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = limits_of(seen, sweep.joint, axis);
    if (high - low < kFixed) continue;
    sweep.arm = axis == 2 ? Vec3(std::min(kTurnRadius, length) * sweep.joint.axes.col(0))
                          : Vec3(length * bone.normalized());
    const auto tip = [&](double degrees) {
      Vec3 angles = now;
      angles[axis] = degrees * kDegree;
      return sweep.tip(angles);
    };
    LimitArc arc{.axis = axis, .middle = sweep.middle, .now = sweep.tip(now)};
    const int steps = std::max(int((high - low) / kMostArc), 2);
    for (int k = 0; k <= steps; ++k) arc.points.push_back(tip(low + (high - low) * k / steps));
    for (const int end : {0, 1}) {
      Handle handle{
          .kind = Handle::Kind::limit, .side = split_side(sweep.joint.name).second, .joint = joint};
      handle.index = end;
      handle.axis = axis;
      handle.value = end == 0 ? low : high;
      handle.middle = sweep.middle;
      handle.place = tip(handle.value);
      handle.name =
          fmt::format("limit:{}:{}", kAngleNames[std::size_t(axis)], end == 0 ? "min" : "max");
      const double whole = std::round(handle.value);
      for (int k = -kWay; k <= kWay; ++k) handle.way.emplace_back(whole + k, tip(whole + k));
      handles.push_back(std::move(handle));
    }
    out.push_back(std::move(arc));
  }
  return out;
}

std::optional<Action> action_of_limit(const DragInput& input, const Handle& handle,
                                      const Vec3& moved, bool one_side) {
  const Joint& joint = input.skeleton.joints[std::size_t(handle.joint)];
  auto [low, high] = limits_of(input.document, joint, handle.axis);
  const Vec3 wanted = handle.place + moved;
  const auto nearest = std::ranges::min_element(
      handle.way, {}, [&](const auto& each) { return (each.second - wanted).squaredNorm(); });
  if (nearest == handle.way.end()) return std::nullopt;
  (handle.index == 0 ? low : high) =
      handle.index == 0 ? std::min(nearest->first, high - 1) : std::max(nearest->first, low + 1);
  const auto tenth = [](double degrees) { return std::round(10 * degrees) / 10 + 0.0; };
  return SetLimits{one_side ? joint.name : split_side(joint.name).first,
                   kAngleNames[std::size_t(handle.axis)], tenth(low), tenth(high)};
}

}  // namespace ecorche
