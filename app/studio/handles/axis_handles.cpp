#include "app/studio/handles/axis_handles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "morph/placement/bone_groups.h"

namespace ecorche {
namespace {

constexpr double kAxisLength = 0.055;  // m

Mat3 turn_by(const Vec3& degrees) {
  const Vec3 angles = kDegree * degrees;
  return (Eigen::AngleAxisd(angles.x(), Vec3::UnitX()) *
          Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()))
      .toRotationMatrix();
}

// The angles that turn_by() takes, deg.
Vec3 angles_of(const Mat3& turn) {
  return Vec3(std::atan2(-turn(1, 2), turn(2, 2)), std::asin(std::clamp(turn(0, 2), -1.0, 1.0)),
              std::atan2(-turn(0, 1), turn(0, 0))) /
         kDegree;
}

Vec3 turned_in(const Document& document, const std::string& name) {
  const auto edit = document.joints->find(name);
  return edit == document.joints->end() ? Vec3(Vec3::Zero()) : edit->second.turned;
}

// What a document turns the built axes by: both sides' edit, then that of one side.
Mat3 turn_in(const Document& document, const std::string& joint) {
  const std::string base = split_side(joint).first;
  const Mat3 both = turn_by(turned_in(document, base));
  return base == joint ? both : Mat3(both * turn_by(turned_in(document, joint)));
}

}  // namespace

void add_axes(const Skeleton& skeleton, const Document& shown_of, const Document& seen, int joint,
              const PosedAnatomy& posed, std::vector<Handle>& handles) {
  const Joint& of = skeleton.joints[std::size_t(joint)];
  if (of.parent < 0) return;
  const Mat3 built = of.axes * turn_in(shown_of, of.name).transpose();
  const Mat3 axes = posed.X_WJ[std::size_t(of.parent)].linear() * built * turn_in(seen, of.name);
  for (int axis = 0; axis < 3; ++axis) {
    Handle handle{.kind = Handle::Kind::axis, .side = split_side(of.name).second, .joint = joint};
    handle.axis = axis;
    handle.built = built;
    handle.middle = posed.X_WJ[std::size_t(joint)].translation();
    handle.place = handle.middle + kAxisLength * axes.col(axis);
    handle.name = fmt::format("axis:{}", kAngleNames[std::size_t(axis)]);
    handles.push_back(std::move(handle));
  }
}

std::optional<Action> action_of_axis(const DragInput& input, const Handle& handle,
                                     const Vec3& moved, bool one_side) {
  const Joint& joint = input.skeleton.joints[std::size_t(handle.joint)];
  const Mat3 parent = input.posed.X_WJ[std::size_t(joint.parent)].linear();
  const Vec3 now = parent.transpose() * (handle.place - handle.middle);
  const Vec3 wanted = parent.transpose() * (handle.place + moved - handle.middle);
  if (wanted.norm() < 0.1 * kAxisLength) return std::nullopt;
  const Mat3 drag = Quat::FromTwoVectors(now, wanted).toRotationMatrix();
  const std::string base = split_side(joint.name).first;
  const Mat3 axes = drag * handle.built * turn_in(input.document, joint.name);
  Mat3 turn = handle.built.transpose() * axes;
  if (one_side && base != joint.name)
    turn = turn_by(turned_in(input.document, base)).transpose() * turn;
  else if (base != joint.name)
    turn = turn * turn_by(turned_in(input.document, joint.name)).transpose();
  const std::string name = one_side ? joint.name : base;
  const Vec3 more = angles_of(turn) - turned_in(input.document, name);
  const auto tenth = [](double degrees) { return std::round(10 * degrees) / 10 + 0.0; };
  const TurnAxes action{name, tenth(more.x()), tenth(more.y()), tenth(more.z())};
  if (action.flexion == 0 && action.abduction == 0 && action.rotation == 0) return std::nullopt;
  return action;
}

}  // namespace ecorche
