#include "app/studio/handles/handles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

constexpr int kCircle = 32;

Transform motion_of(int joint, std::span<const Vec3> joint_rest, const PosedAnatomy& posed) {
  const std::size_t j = std::size_t(joint);
  return posed.X_WJ[j] * Eigen::Translation3d(-joint_rest[j]);
}

// How far a step at rest goes now.
Mat3 turn_of(const PathPoint& point, const PosedAnatomy& posed) {
  const Mat3 first = posed.X_WJ[std::size_t(point.joints[0])].linear();
  if (point.joints[1] < 0) return first;
  return point.share * first +
         (1 - point.share) * posed.X_WJ[std::size_t(point.joints[1])].linear();
}

// A step in the template's body and in the bone package's skeleton, by what a step of 2 mm does.
Mat3 placed_by(const DragInput& input, const Vec3& place, int of) {
  constexpr double step = 2e-3;
  Workshop& workshop = input.workshop;
  // a joint of one's own goes with the built-in one that it hangs on
  int joint = -1;
  for (; joint < 0 && of >= 0; of = input.skeleton.joints[std::size_t(of)].parent)
    joint = find_joint(workshop.source().skeleton, input.skeleton.joints[std::size_t(of)].name);
  joint = std::max(joint, 0);
  Mat3 out;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 to_side = step * Vec3::Unit(axis);
    out.col(axis) = (workshop.warp().by_joint(joint, place + to_side) -
                     workshop.warp().by_joint(joint, place - to_side)) /
                    (2 * step);
  }
  return out;
}

Vec3 rounded(const Vec3& metres_moved) {
  Vec3 out = 1e3 * metres_moved;
  for (double& value : out) value = std::round(10 * value) / 10 + 0.0;
  return out;
}

void add_circle(const Transform& frame, const Vec3& a, const Vec3& b, const Vec3& middle,
                std::vector<WireShape>& out) {
  WireShape shape{.kind = WireShape::Kind::wrap, .closed = true};
  for (int i = 0; i < kCircle; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCircle;
    const Vec3 point = middle + std::cos(angle) * a + std::sin(angle) * b;
    shape.points.push_back((frame * point).cast<float>());
  }
  out.push_back(std::move(shape));
}

void add_wrap(const Wrap& wrap, std::span<const Vec3> joint_rest, const PosedAnatomy& posed,
              std::vector<WireShape>& out) {
  const Transform frame = motion_of(wrap.joint, joint_rest, posed) * wrap.X_WO;
  const Vec3 x = wrap.radii.x() * Vec3::UnitX(), y = wrap.radii.y() * Vec3::UnitY(),
             z = wrap.radii.z() * Vec3::UnitZ();
  if (wrap.kind != Wrap::Kind::cylinder) {
    add_circle(frame, x, y, Vec3::Zero(), out);
    add_circle(frame, y, z, Vec3::Zero(), out);
    add_circle(frame, z, x, Vec3::Zero(), out);
    return;
  }
  for (const double end : {-1.0, 0.0, 1.0}) add_circle(frame, x, y, end * z, out);
  for (const Vec3& side : {x, y, Vec3(-x), Vec3(-y)})
    out.push_back({WireShape::Kind::wrap,
                   {(frame * Vec3(side - z)).cast<float>(), (frame * Vec3(side + z)).cast<float>()},
                   false});
}

std::optional<Action> drag_of_point(const DragInput& input, const Handle& handle, const Vec3& rest,
                                    bool one_side) {
  const Document& document = input.document;
  const int entry = find_entry(document, document.picked);
  if (entry < 0) return std::nullopt;
  const EditedMuscle& edited = *document.muscles[std::size_t(entry)];
  const bool right = handle.side == Side::right;
  const TableMuscle& muscle = right && edited.right ? *edited.right : edited.left;
  if (handle.strip >= int(muscle.strips.size())) return std::nullopt;
  const TableStrip& strip = muscle.strips[std::size_t(handle.strip)];
  if (handle.point >= int(strip.path.size())) return std::nullopt;
  const Vec3 at = position(*document.frame, strip.path[std::size_t(handle.point)]);
  MovePoint action;
  action.muscle = document.picked + (one_side ? (right ? "_r" : "_l") : "");
  action.strip = handle.strip + 1;
  action.point = handle.point + 1;
  action.by = step_in_table(input, at, handle.at.joints[0], handle.side, rest);
  return action.by.isZero() ? std::nullopt : std::optional<Action>(action);
}

std::optional<Action> drag_of_joint(const DragInput& input, const Handle& handle, const Vec3& rest,
                                    bool one_side) {
  const std::string& name = input.skeleton.joints[std::size_t(handle.joint)].name;
  const auto& [base, side] = split_side(name);
  const Vec3 step = input.carrier.stretch(handle.joint).inverse() * rest;
  MoveJoint action;
  action.joint = one_side ? name : base;
  action.by = rounded({side == Side::right ? -step.x() : step.x(), step.y(), step.z()});
  return action.by.isZero() ? std::nullopt : std::optional<Action>(action);
}

}  // namespace

// The table is of the left side; what carries a place there carries the mirror image here.
Vec3 step_in_table(const DragInput& input, const Vec3& at, int joint, Side side, const Vec3& rest) {
  const auto& [base, own] = split_side(input.skeleton.joints[std::size_t(joint)].name);
  const int mirror = own == Side::right ? find_joint(input.skeleton, base + "_l") : joint;
  const int left = mirror < 0 ? joint : mirror;
  const Vec3 mirrored(side == Side::right ? -rest.x() : rest.x(), rest.y(), rest.z());
  const Mat3 step = input.carrier.stretch(left) * placed_by(input, at, left);
  return rounded(step.inverse() * mirrored);
}

Vec3 rest_step(const PathPoint& at, const PosedAnatomy& posed, const Vec3& moved) {
  return turn_of(at, posed).inverse() * moved;
}

Vec3 posed_place(const PathPoint& point, std::span<const Vec3> joint_rest,
                 const PosedAnatomy& posed) {
  const Vec3 first = motion_of(point.joints[0], joint_rest, posed) * point.rest;
  if (point.joints[1] < 0) return first;
  return point.share * first +
         (1 - point.share) * (motion_of(point.joints[1], joint_rest, posed) * point.rest);
}

void add_points(const Muscle& muscle, std::span<const Vec3> joint_rest, const PosedAnatomy& posed,
                std::vector<Handle>& out) {
  for (int k = 0; k < int(muscle.strips.size()); ++k) {
    const std::vector<PathPoint>& path = muscle.strips[std::size_t(k)].path;
    for (int i = 0; i < int(path.size()); ++i) {
      const PathPoint& at = path[std::size_t(i)];
      out.push_back({.kind = Handle::Kind::point,
                     .side = muscle.side,
                     .strip = k,
                     .point = i,
                     .points = int(path.size()),
                     .at = at,
                     .place = posed_place(at, joint_rest, posed),
                     .name = fmt::format("point{}:{}:{}", muscle.side == Side::right ? "_r" : "",
                                         k + 1, i + 1)});
    }
  }
}

void add_joints(const Skeleton& skeleton, const PosedAnatomy& posed, std::vector<Handle>& out) {
  for (int j = 0; j < int(skeleton.joints.size()); ++j) {
    const Joint& joint = skeleton.joints[std::size_t(j)];
    out.push_back({.kind = Handle::Kind::joint,
                   .side = split_side(joint.name).second,
                   .joint = j,
                   .at = {Vec3::Zero(), {std::max(joint.parent, 0), -1}, 1},
                   .place = posed.X_WJ[std::size_t(j)].translation(),
                   .name = "joint:" + joint.name});
  }
}

void add_wires(const Muscle& muscle, std::span<const Ellipse> slices,
               std::span<const Vec3> joint_rest, const PosedAnatomy& posed,
               std::vector<WireShape>& out) {
  std::size_t at = 0;
  for (const Strip& strip : muscle.strips) {
    WireShape line{.kind = WireShape::Kind::line};
    for (std::size_t k = 0; k < strip.slices.size() && at < slices.size(); ++k, ++at) {
      const Ellipse& e = slices[at];
      line.points.push_back(e.center.cast<float>());
      if (k % 2 == 1) continue;  // every second one can be told from its neighbours
      WireShape section{.kind = WireShape::Kind::section, .closed = true};
      for (int i = 0; i < kOutlinePoints; ++i) {
        const double angle = 2 * std::numbers::pi * i / kOutlinePoints;
        const Vec3 point = e.center + double(e.outline[std::size_t(i)]) *
                                          (e.radii.x() * std::cos(angle) * e.axes.col(0) +
                                           e.radii.y() * std::sin(angle) * e.axes.col(1));
        section.points.push_back(point.cast<float>());
      }
      out.push_back(std::move(section));
    }
    out.push_back(std::move(line));
    for (const Wrap& wrap : strip.wraps) add_wrap(wrap, joint_rest, posed, out);
  }
}

std::optional<Action> action_of_drag(const DragInput& input, const Handle& handle,
                                     const Vec3& moved, bool one_side) {
  const Vec3 rest = rest_step(handle.at, input.posed, moved);
  return handle.kind == Handle::Kind::point ? drag_of_point(input, handle, rest, one_side)
                                            : drag_of_joint(input, handle, rest, one_side);
}

}  // namespace ecorche
