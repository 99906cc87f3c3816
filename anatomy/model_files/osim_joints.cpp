#include "anatomy/model_files/osim_joints.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/model_files/model_xml.h"
#include "anatomy/model_files/osim_functions.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;

bool is_true(const char* text) {
  return std::string_view(text).find("true") != std::string_view::npos;
}

std::vector<std::string> words(const char* text) {
  std::vector<std::string> out;
  std::string word;
  for (const char* at = text;; ++at) {
    if (*at == '\0' || *at == ' ' || *at == '\t' || *at == '\n' || *at == '\r') {
      if (!word.empty()) out.push_back(word);
      word.clear();
      if (*at == '\0') return out;
    } else {
      word += *at;
    }
  }
}

// Which of a joint's coordinates are angles, by its kind; those of a CustomJoint by where they are
// used.
std::vector<bool> turning(const OsimJoint& joint) {
  std::vector<bool> turns(joint.coordinates.size(), true);
  if (joint.kind == "SliderJoint") std::fill(turns.begin(), turns.end(), false);
  if (joint.kind == "FreeJoint")
    for (size_t i = 3; i < turns.size(); ++i) turns[i] = false;
  if (joint.kind == "PlanarJoint")
    for (size_t i = 1; i < turns.size(); ++i) turns[i] = false;
  if (joint.kind == "CustomJoint") {
    std::set<std::string> used;
    for (pugi::xml_node axis : joint.node.child("SpatialTransform").children("TransformAxis"))
      if (std::string_view(axis.attribute("name").value()).starts_with("rotation"))
        for (const std::string& name : words(axis.child_value("coordinates"))) used.insert(name);
    for (size_t i = 0; i < turns.size(); ++i) turns[i] = used.count(joint.coordinates[i]) > 0;
  }
  return turns;
}

Mat3 turn(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

Transform custom(const OsimJoint& joint, const OsimCoordinates& coordinates, int pose) {
  Transform X = Transform::Identity();
  Mat3 R = Mat3::Identity();
  Vec3 p = Vec3::Zero();
  for (pugi::xml_node axis : joint.node.child("SpatialTransform").children("TransformAxis")) {
    const std::string name = axis.attribute("name").value();
    const std::string where = fmt::format("{}: {}", joint.where, name);
    Vec3 direction = model_xml::vector3(axis.child_value("axis"), where + ": axis");
    if (direction.norm() < 1e-12) throw InputError(where + ": axis has no length");
    direction.normalize();
    const auto used = words(axis.child_value("coordinates"));
    const double x = used.empty() ? 0 : coordinates.value(used[0], pose, where);
    const pugi::xml_node function = find_osim_function(axis);
    const double y = function ? osim_function(function, x, where) : used.empty() ? 0 : x;
    if (name.starts_with("rotation"))
      R = R * turn(direction, y);
    else if (name.starts_with("translation"))
      p += y * direction;
    else
      throw InputError(fmt::format("{}: expected rotation1 .. translation3", where));
  }
  X.linear() = R;
  X.translation() = p;
  return X;
}

// The shoulder blade on an ellipsoid (Seth et al. 2016, 10.1371/journal.pone.0141028): abduction
// and elevation move it about the first two axes of a frame that is turned a quarter about z,
// upward rotation about the third; then winging about an axis in the blade.
Transform scapulothoracic(const OsimJoint& joint, const std::vector<double>& q) {
  const Vec3 radii = model_xml::vector3(joint.node.child_value("thoracic_ellipsoid_radii_x_y_z"),
                                        joint.where + ": thoracic_ellipsoid_radii_x_y_z");
  const Mat3 quarter = turn(Vec3::UnitZ(), kHalfTurn / 2);
  const Mat3 R = model_xml::body_xyz({q[0], q[1], q[2]});
  Transform X = Transform::Identity();
  const Vec3 normal = quarter * R.col(2);
  X.linear() = quarter * R * quarter.transpose();
  X.translation() = normal.cwiseProduct(radii);
  const auto origin = model_xml::numbers(joint.node.child_value("scapula_winging_axis_origin"),
                                         joint.where + ": scapula_winging_axis_origin", 2);
  const double direction =
      joint.node.child("scapula_winging_axis_direction")
          ? model_xml::number(joint.node.child_value("scapula_winging_axis_direction"),
                              joint.where + ": scapula_winging_axis_direction")
          : 0;
  if (q.size() < 4 || origin.size() != 2) return X;
  const Vec3 at(origin[0], origin[1], 0), along = turn(Vec3::UnitZ(), -direction) * Vec3::UnitY();
  return X * Eigen::Translation3d(at) * Eigen::AngleAxisd(q[3], along) * Eigen::Translation3d(-at);
}

}  // namespace

void OsimCoordinates::add(const OsimJoint& joint) {
  const std::vector<bool> turns = turning(joint);
  size_t index = 0;
  const auto declare = [&](pugi::xml_node node) {
    const std::string name = node.attribute("name").value(),
                      where = fmt::format("{}: coordinate '{}'", joint.where, name);
    OsimCoordinate c;
    c.turns = index < turns.size() && turns[index];
    ++index;
    if (node.child("default_value"))
      c.initial = model_xml::number(node.child_value("default_value"), where + ": default_value");
    c.locked = is_true(node.child_value("locked"));
    if (node.child("range") && is_true(node.child_value("clamped"))) {
      const auto range = model_xml::numbers(node.child_value("range"), where + ": range", 2);
      if (range.size() != 2 || range[0] > range[1])
        throw InputError(where + ": range: two rising numbers expected");
      c.limited = true;
      c.low = range[0];
      c.high = range[1];
    }
    if (!coordinates_.emplace(name, c).second)
      throw InputError(fmt::format("{}: there are two of this name", where));
  };
  for (pugi::xml_node node : joint.node.child("coordinates").children("Coordinate")) declare(node);
  for (pugi::xml_node node :
       joint.node.child("CoordinateSet").child("objects").children("Coordinate"))
    declare(node);
}

void OsimCoordinates::couple(pugi::xml_node node, const std::string& where) {
  if (std::string_view(node.child_value("isEnforced")) == "false" ||
      std::string_view(node.child_value("isDisabled")) == "true")
    return;
  Coupling c{node.child_value("dependent_coordinate_name"),
             words(node.child_value("independent_coordinate_names")),
             find_osim_function(node.child("coupled_coordinates_function")), 1, where};
  if (node.child("scale_factor"))
    c.scale = model_xml::number(node.child_value("scale_factor"), where + ": scale_factor");
  if (!coordinates_.count(c.dependent))
    throw InputError(fmt::format("{}: unknown coordinate '{}'", where, c.dependent));
  if (!c.function || c.independent.empty())
    throw InputError(where + ": a function of an independent coordinate expected");
  couplings_.push_back(std::move(c));
}

void OsimCoordinates::settle() {
  for (int pose = 0; pose < kModelPoses; ++pose) {
    auto& values = values_[pose];
    for (const auto& [name, c] : coordinates_) {
      values[name] = c.initial;
      if (pose == kZeroPose && c.turns && !c.locked)
        values[name] = c.limited ? std::clamp(0.0, c.low, c.high) : 0;
    }
    // A dependent coordinate may drive another one; chains of four are followed.
    for (int round = 0; round < 4; ++round)
      for (const Coupling& c : couplings_) {
        if (coordinates_.at(c.dependent).locked) continue;
        values[c.dependent] =
            c.scale * osim_function(c.function, value(c.independent[0], pose, c.where), c.where);
      }
  }
}

double OsimCoordinates::value(const std::string& name, int pose, const std::string& where) const {
  const auto found = values_[pose].find(name);
  if (found == values_[pose].end())
    throw InputError(fmt::format("{}: unknown coordinate '{}'", where, name));
  return found->second;
}

Transform osim_joint_transform(const OsimJoint& joint, const OsimCoordinates& coordinates, int pose,
                               std::vector<std::string>& notes) {
  std::vector<double> q;
  for (const std::string& name : joint.coordinates)
    q.push_back(coordinates.value(name, pose, joint.where));
  const auto need = [&](size_t count) {
    if (q.size() != count)
      throw InputError(fmt::format("{}: a {} has {} coordinates, not {}", joint.where, joint.kind,
                                   count, q.size()));
  };
  Transform X = Transform::Identity();
  if (joint.kind == "CustomJoint") return custom(joint, coordinates, pose);
  if (joint.kind == "WeldJoint") return X;
  if (joint.kind == "PinJoint") {
    need(1);
    X.linear() = turn(Vec3::UnitZ(), q[0]);
  } else if (joint.kind == "SliderJoint") {
    need(1);
    X.translation().x() = q[0];
  } else if (joint.kind == "UniversalJoint") {
    need(2);
    X.linear() = turn(Vec3::UnitX(), q[0]) * turn(Vec3::UnitY(), q[1]);
  } else if (joint.kind == "BallJoint" || joint.kind == "GimbalJoint") {
    need(3);
    X.linear() = model_xml::body_xyz({q[0], q[1], q[2]});
  } else if (joint.kind == "PlanarJoint") {
    need(3);
    X.linear() = turn(Vec3::UnitZ(), q[0]);
    X.translation() << q[1], q[2], 0;
  } else if (joint.kind == "FreeJoint") {
    need(6);
    X.linear() = model_xml::body_xyz({q[0], q[1], q[2]});
    X.translation() << q[3], q[4], q[5];
  } else if (joint.kind == "EllipsoidJoint") {
    need(3);
    X.linear() = model_xml::body_xyz({q[0], q[1], q[2]});
    X.translation() = X.linear().col(2).cwiseProduct(
        model_xml::vector3(joint.node.child_value("radii_x_y_z"), joint.where + ": radii_x_y_z"));
  } else if (joint.kind == "ScapulothoracicJoint") {
    need(4);
    return scapulothoracic(joint, q);
  } else {
    const std::string note =
        fmt::format("{}: kind '{}' is not understood; taken as fixed", joint.where, joint.kind);
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  }
  return X;
}

}  // namespace ecorche::inline v1
