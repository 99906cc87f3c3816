#include "skinning/lift/chair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "anatomy/joint_angles.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kHalfWidth = 0.23, kBackHalfWidth = 0.20;  // m
constexpr double kBackHeight = 0.48, kBackGap = 0.17;       // m, above the seat its lower edge
constexpr double kSeatBehind = 0.06;                        // m, beyond the buttocks
constexpr double kBeforeKnee = 0.05;                        // m, from the seat's end to the calf
constexpr double kFloorStiffness = 2e7;                     // Pa/m
// Nm/rad of the trunk's, the neck's, hips' and knees' effort.
constexpr double kTrunk = 200, kNeck = 30, kHip = 10, kKnee = 10;
constexpr double kUprightTrunk = 500, kUprightHip = 250;

// Furthest along a direction over the vertices of regions that begin with one of these names.
struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

Extent extent_of(const Patient& patient, const Points& skin, const Vec3& along,
                 const std::vector<std::string>& names, double above) {
  Extent out;
  for (Eigen::Index i = 0; i < skin.rows(); ++i) {
    const std::string& region = patient.regions[std::size_t(patient.region[std::size_t(i)])];
    if (skin(i, 1) < above || std::ranges::none_of(names, [&](const std::string& name) {
          return region.starts_with(name);
        }))
      continue;
    const double at = skin.row(i) * along;
    out.low = std::min(out.low, at);
    out.high = std::max(out.high, at);
  }
  return out;
}

}  // namespace

std::vector<Pad> make_chair(const Patient& patient, const Points& skin,
                            const ChairOptions& options) {
  const auto along = [&](const Vec3& axis, const std::vector<std::string>& names,
                         double above = -std::numeric_limits<double>::infinity()) {
    return extent_of(patient, skin, axis, names, above);
  };
  const double top = along(Vec3::UnitY(), {"buttocks", "thigh", "body"}).low;
  const double behind = along(Vec3::UnitZ(), {"buttocks", "body"}).low - kSeatBehind;
  const double calf = along(Vec3::UnitZ(), {"lower_leg", "body"}).low;
  const double front = std::max(calf - kBeforeKnee, behind + 0.2);
  Pad seat;
  seat.name = "seat";
  seat.X_WP.translation() = Vec3(0, top, 0.5 * (front + behind));
  seat.half_width = kHalfWidth;
  seat.half_length = 0.5 * (front - behind);
  seat.stiffness = options.foam / options.thickness;
  seat.bottom = 0.8 * options.thickness;
  std::vector<Pad> out{seat};
  if (options.back) {
    const double turn = kDegree * options.recline;
    const Vec3 n(0, std::sin(turn), std::cos(turn)), up(0, std::cos(turn), -std::sin(turn));
    const double gap = top + kBackGap;
    const double at = along(n, {"lower_back", "upper_back", "buttocks", "body"}, gap).low;
    Pad back = seat;
    back.name = "back";
    back.half_width = kBackHalfWidth;
    back.half_length = 0.5 * kBackHeight;
    back.X_WP.linear().col(0) = n.cross(up);
    back.X_WP.linear().col(1) = n;
    back.X_WP.linear().col(2) = up;
    // From the point of the plane at the height of the lower edge.
    const Vec3 edge(0, gap, (at - n.y() * gap) / n.z());
    back.X_WP.translation() = edge + back.half_length * up;
    out.push_back(back);
  }
  if (options.floor) {
    Pad floor;
    floor.name = "floor";
    const Extent feet = along(Vec3::UnitZ(), {"foot", "body"});
    floor.X_WP.translation() =
        Vec3(0, along(Vec3::UnitY(), {"foot", "body"}).low, 0.5 * (feet.low + feet.high));
    floor.half_width = 0.35;
    floor.half_length = 0.5 * (feet.high - feet.low) + 0.15;
    floor.stiffness = kFloorStiffness;
    floor.bottom = 1;
    out.push_back(floor);
  }
  return out;
}

void keep_seated(bool back, Patient& patient) {
  for (PassiveJoint& group : patient.groups) {
    const std::string& name = patient.skeleton.joints[std::size_t(group.joints[0])].name;
    if (name == "l5") group.stiffness = back ? kTrunk : kUprightTrunk;
    if (name == "c7") group.stiffness = kNeck;
    if (name.starts_with("hip")) group.stiffness = back ? kHip : kUprightHip;
    if (name.starts_with("knee")) group.stiffness = kKnee;
  }
}

Vec3 lowest_of_bone(const Anatomy& anatomy, const std::string& bone, const Pose& pose) {
  const auto found = std::ranges::find(anatomy.bones, bone, &Bone::name);
  if (found == anatomy.bones.end())
    throw std::invalid_argument(fmt::format("lowest_of_bone: no bone '{}'", bone));
  std::vector<Transform> X_WJ;
  forward_kinematics(anatomy.skeleton, pose, X_WJ);
  const Transform& X = X_WJ[std::size_t(found->joint)];
  const Vec3 rest = rest_positions(anatomy.skeleton)[std::size_t(found->joint)];
  Vec3 out(0, std::numeric_limits<double>::infinity(), 0);
  for (Eigen::Index i = 0; i < found->mesh.V.rows(); ++i) {
    const Vec3 p = X * Vec3(found->mesh.V.row(i).transpose() - rest);
    if (p.y() < out.y()) out = p;
  }
  return out;
}

}  // namespace ecorche::inline v1
