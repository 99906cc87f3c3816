#include "anatomy/authoring/capsule_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "anatomy/bones/mirror.h"
#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kCapsuleUnit = 1e-3;
constexpr int kRings = 5, kAround = 12;  // control points of a sleeve
// Faces of a joint are what lies nearer to the other bone than the nearest place and this much.
constexpr double kFaces = 1.5e-3, kFacesOfRadius = 0.05;  // m; share of the sleeve's radius
constexpr double kDiscFaces = 4e-3;  // m, of ends of vertebrae, which are aslant to each other
constexpr double kSlab = 3e-3, kSlabOfRadius = 0.15;  // half thickness of a ring's slice of bone

[[noreturn]] void fail(const CapsuleRule& rule, const std::string& message) {
  throw InputError(fmt::format("{}: {}: {}", rule.where, rule.name, message));
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

double millimetres(const Table& table, int row, const CapsuleRule& rule, const char* column,
                   double low, double high) {
  const double value = table.number(row, column);
  if (value < low || value > high)
    fail(rule, fmt::format("{}: {} is not within {} .. {}", column, value, low, high));
  return value * kCapsuleUnit;
}

CapsuleRule read_capsule(const Table& table, int row) {
  CapsuleRule rule;
  rule.name = table.text(row, "capsule");
  rule.where = table.where(row);
  if (rule.name.empty()) fail(rule, "the name is missing");
  const std::string paired = table.text(row, "paired"), kind = table.text(row, "kind");
  if (paired != "yes" && paired != "no")
    fail(rule, fmt::format("paired: '{}'; expected yes or no", paired));
  if (kind != "capsule" && kind != "disc")
    fail(rule, fmt::format("kind: '{}'; expected capsule or disc", kind));
  rule.paired = paired == "yes";
  rule.disc = kind == "disc";
  rule.label = table.text(row, "label");
  rule.group = table.text(row, "group");
  rule.source = table.text(row, "source");
  if (rule.label.empty() || rule.group.empty()) fail(rule, "label or group is missing");
  rule.near = words(table.text(row, "near"));
  rule.far = words(table.text(row, "far"));
  if (rule.near.empty() || rule.far.empty()) fail(rule, "a bone is missing in near or far");
  for (int k = 0; k < 3; ++k)
    rule.axis[k] =
        table.number_or(row, std::array{"axis_left", "axis_up", "axis_front"}[std::size_t(k)], 0);
  if (!table.text(row, "at_left").empty())
    rule.at = Vec3(kSourceMidPlane + kCapsuleUnit * table.number(row, "at_left"),
                   kCapsuleUnit * table.number(row, "at_up"),
                   kCapsuleUnit * table.number(row, "at_front"));
  rule.up = millimetres(table, row, rule, "up_mm", -50, 100);
  rule.down = millimetres(table, row, rule, "down_mm", -50, 100);
  if (rule.up + rule.down < kCapsuleUnit) fail(rule, "up_mm and down_mm leave no room between");
  rule.radius = millimetres(table, row, rule, "radius_mm", 2, 100);
  rule.thickness = millimetres(table, row, rule, "thickness_mm", 0.1, 20);
  return rule;
}

std::vector<CapsuleRule> read_capsules(const Table& table) {
  std::vector<CapsuleRule> rules;
  for (int row = 0; row < table.rows(); ++row) {
    CapsuleRule rule = read_capsule(table, row);
    if (std::ranges::any_of(rules, [&](const CapsuleRule& r) { return r.name == rule.name; }))
      fail(rule, "it is given twice");
    rules.push_back(std::move(rule));
  }
  return rules;
}

// The rows of several matrices.
Points stacked(const std::vector<const Bone*>& bones) {
  Eigen::Index rows = 0;
  for (const Bone* bone : bones) rows += bone->mesh.V.rows();
  Points out(rows, 3);
  rows = 0;
  for (const Bone* bone : bones) {
    out.middleRows(rows, bone->mesh.V.rows()) = bone->mesh.V;
    rows += bone->mesh.V.rows();
  }
  return out;
}

// Those among which a joint's faces are looked for: of a disc on the mid-plane, the front half of
// what they span (the bodies of vertebrae, without their arches).
Points face_points(const CapsuleRule& rule, const Points& points) {
  const double middle = (points.col(2).minCoeff() + points.col(2).maxCoeff()) / 2;
  Points out(points.rows(), 3);
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (rule.disc && !rule.paired && points(i, 2) < middle) continue;
    if (rule.at && (points.row(i).transpose() - *rule.at).norm() > rule.radius) continue;
    out.row(kept++) = points.row(i);
  }
  out.conservativeResize(kept, 3);
  return out;
}

struct Faces {
  Vec3 middle = Vec3::Zero(), axis = Vec3::Zero();
};

// Where two clouds of points face each other.
Faces facing(const Points& near, const Points& far, double radius, double margin) {
  std::vector<Eigen::Index> nearest(std::size_t(near.rows()));
  std::vector<double> distance(nearest.size());
  if (near.rows() == 0 || far.rows() == 0) return {};
  const Eigen::RowVector3d low = far.colwise().minCoeff().array() - radius,
                           high = far.colwise().maxCoeff().array() + radius;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const Eigen::RowVector3d p = near.row(Eigen::Index(i));
    distance[i] = std::numeric_limits<double>::infinity();
    if ((p.array() < low.array()).any() || (p.array() > high.array()).any()) continue;
    distance[i] = std::sqrt((far.rowwise() - p).rowwise().squaredNorm().minCoeff(&nearest[i]));
    least = std::min(least, distance[i]);
  }
  Faces out;
  int count = 0;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (distance[i] > least + margin || std::isinf(distance[i])) continue;
    const Vec3 a = near.row(Eigen::Index(i)), b = far.row(nearest[i]);
    out.middle += (a + b) / 2;
    if (distance[i] > 0) out.axis += (b - a) / distance[i];
    ++count;
  }
  if (count > 0) out.middle /= count;
  if (out.axis.norm() > 0) out.axis.normalize();
  return out;
}

// The middle of what bones have in a slice across the axis.
Vec3 ring_centre(const CapsuleRule& rule, const Points& bones, const Faces& faces, double along,
                 const std::string& names) {
  const double slab = std::max(kSlab, kSlabOfRadius * rule.radius);
  const Vec3 at = faces.middle + along * faces.axis;
  Eigen::AlignedBox3d box;
  for (Eigen::Index i = 0; i < bones.rows(); ++i) {
    const Vec3 offset = bones.row(i).transpose() - at;
    const double beside = offset.dot(faces.axis);
    const Vec3 across = offset - beside * faces.axis;
    if (std::abs(beside) < slab && across.norm() < rule.radius) box.extend(Vec3(at + across));
  }
  if (box.isEmpty())
    fail(rule, fmt::format("{}: nothing within {:.0f} mm of the axis, {:.0f} mm from the middle of "
                           "the joint",
                           names, rule.radius / kCapsuleUnit, along / kCapsuleUnit));
  const Vec3 centre = box.center();
  return centre - (centre - at).dot(faces.axis) * faces.axis;
}

std::vector<const Bone*> bones_of(const CapsuleRule& rule, const std::vector<std::string>& names,
                                  const Anatomy& source) {
  std::vector<const Bone*> out;
  for (const std::string& name : names) {
    int index = rule.paired ? find_bone(source, name + side_suffix(Side::left)) : -1;
    if (index < 0) index = find_bone(source, name);
    if (index < 0) fail(rule, fmt::format("no bone '{}' in the skeleton", name));
    out.push_back(&source.bones[std::size_t(index)]);
  }
  return out;
}

FasciaPlan place_on_left(const CapsuleRule& rule, const Anatomy& source) {
  const auto near = bones_of(rule, rule.near, source), far = bones_of(rule, rule.far, source);
  const Points near_points = stacked(near), far_points = stacked(far);
  const bool spine = rule.disc && !rule.paired;
  const Points near_faces = face_points(rule, near_points),
               far_faces = face_points(rule, far_points);
  Faces faces = facing(near_faces, far_faces, rule.radius,
                       (spine ? kDiscFaces : kFaces) + kFacesOfRadius * rule.radius);
  if (spine) faces.axis.x() = 0, faces.axis.normalize();
  if (rule.axis.norm() > 0) faces.axis = rule.axis.normalized();
  if (faces.axis.norm() == 0 || faces.middle.isZero())
    fail(rule, "its bones face each other nowhere; give an axis");
  const Vec3 first_end = ring_centre(rule, spine ? near_faces : near_points, faces, -rule.up,
                                     near[0]->name),
             last_end = ring_centre(rule, spine ? far_faces : far_points, faces, rule.down,
                                    far.back()->name);
  // a ring beyond the middle, on the rim of a deep socket, leaves it out
  const bool between = rule.up > 0 && rule.down > 0;
  const Vec3 ends[3] = {first_end, between ? faces.middle : Vec3((first_end + last_end) / 2),
                        last_end};
  FasciaPlan plan;
  plan.name = rule.name + side_suffix(rule.paired ? Side::left : Side::middle);
  plan.side = rule.paired ? Side::left : Side::middle;
  plan.label = rule.label;
  plan.group = rule.group;
  plan.thickness = rule.thickness;
  plan.form = rule.disc ? FasciaPlan::Form::disc : FasciaPlan::Form::capsule;
  for (const Bone* bone : near) plan.bones.push_back(bone->name);
  for (const Bone* bone : far) plan.bones.push_back(bone->name);
  plan.near = int(near.size());
  plan.rows = kRings;
  plan.columns = kAround;
  const Vec3 seen = std::abs(faces.axis.z()) < 0.8 ? Vec3::UnitZ() : Vec3::UnitX();
  const Vec3 first = (seen - seen.dot(faces.axis) * faces.axis).normalized(),
             second = faces.axis.cross(first);
  for (int r = 0; r < kRings; ++r) {
    const double t = double(r) / (kRings - 1);
    const Vec3 centre = t < 0.5 ? Vec3(ends[0] + 2 * t * (ends[1] - ends[0]))
                                : Vec3(ends[1] + (2 * t - 1) * (ends[2] - ends[1]));
    for (int c = 0; c < kAround; ++c) {
      const double angle = 2 * std::numbers::pi * c / kAround;
      PathPoint point;
      point.rest = centre + rule.radius * (std::cos(angle) * first + std::sin(angle) * second);
      point.joints = {near.front()->joint, far.back()->joint};
      point.share = 1 - t;
      if (r + 1 == kRings) point.joints = {far.back()->joint, -1}, point.share = 1;
      if (r == 0 || point.joints[0] == point.joints[1]) point.joints[1] = -1, point.share = 1;
      plan.points.push_back(point);
    }
  }
  return plan;
}

int mirror_joint(const Anatomy& source, int joint) {
  const int other =
      find_joint(source.skeleton, mirror_name(source.skeleton.joints[std::size_t(joint)].name));
  return other >= 0 ? other : joint;
}

// Columns run the other way round, so that the outside stays outside.
FasciaPlan mirrored_capsule(const CapsuleRule& rule, const FasciaPlan& left,
                            const Anatomy& source) {
  FasciaPlan plan = left;
  plan.name = rule.name + side_suffix(Side::right);
  plan.side = Side::right;
  for (std::string& bone : plan.bones) bone = mirror_name(bone);
  for (int r = 0; r < plan.rows; ++r)
    for (int c = 0; c < plan.columns; ++c) {
      PathPoint point =
          left.points[std::size_t(r * plan.columns + (plan.columns - c) % plan.columns)];
      point.rest = mirror_point(point.rest);
      for (int& joint : point.joints)
        if (joint >= 0) joint = mirror_joint(source, joint);
      plan.points[std::size_t(r * plan.columns + c)] = point;
    }
  return plan;
}

}  // namespace

std::vector<CapsuleRule> read_capsule_text(std::string_view text, const std::string& name) {
  return read_capsules(Table(text, name));
}

std::vector<CapsuleRule> read_capsule_rules(const std::filesystem::path& tables) {
  return read_capsules(Table(tables / "capsules.csv"));
}

std::vector<FasciaPlan> place_capsules(const std::vector<CapsuleRule>& rules,
                                       const Anatomy& source) {
  std::vector<FasciaPlan> plans;
  for (const CapsuleRule& rule : rules) {
    plans.push_back(place_on_left(rule, source));
    if (rule.paired) plans.push_back(mirrored_capsule(rule, FasciaPlan(plans.back()), source));
  }
  return plans;
}

}  // namespace ecorche::inline v1
