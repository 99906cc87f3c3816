#include "skinning/evaluation/pose_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "skinning/evaluation/contact_folds.h"
#include "skinning/motion/pose_book.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kForearmTurn = 150 * std::numbers::pi / 180;

double signed_volume(const Triangles& F, const Points& V) {
  double six = 0;
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    six += Vec3(V.row(F(f, 0))).dot(Vec3(V.row(F(f, 1))).cross(Vec3(V.row(F(f, 2)))));
  return six / 6;
}

}  // namespace

PoseFigures measure_pose(const TriMesh& rest, const BlendTables& tables,
                         std::span<const Transform> X_WJ, const SkinFrame& frame) {
  PoseFigures out;
  Points V;
  to_points(frame, V);
  const std::vector<int> flipped = flipped_triangles(rest, tables, X_WJ, V);
  const std::vector<char> folded = in_contact_folds(rest, V, flipped);
  out.flipped = flipped.size();
  out.flipped_outside = out.flipped - int(std::count(folded.begin(), folded.end(), 1));
  const double before = signed_volume(rest.F, rest.V);
  out.body_volume_change = (signed_volume(rest.F, V) - before) / before;
  std::vector<double> changes;
  for (Eigen::Index f = 0; f < rest.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = rest.F(f, k), b = rest.F(f, (k + 1) % 3);
      const double length = (rest.V.row(a) - rest.V.row(b)).norm();
      if (a < b && length > 0)
        changes.push_back(std::abs((V.row(a) - V.row(b)).norm() / length - 1));
    }
  if (changes.empty()) return out;
  const auto p99 = changes.begin() + std::ptrdiff_t(0.99 * double(changes.size() - 1));
  std::nth_element(changes.begin(), p99, changes.end());
  out.edge_change_p99 = *p99;
  return out;
}

namespace {

LimbSection section_of(const std::string& name, const std::set<int>& joints, const TriMesh& skin,
                       const Binding& binding) {
  LimbSection section{name, {}, {}};
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    double weight = 0;
    for (int k = 0; k < 3; ++k)
      for (const Influence& w : binding.joint_weights[skin.F(f, k)])
        if (joints.count(w.joint) > 0) weight += w.weight / 3;
    if (weight > 0.5) section.triangles.push_back(int(f));
  }
  section.rims = open_rims(section.triangles, skin.F);
  return section;
}

}  // namespace

std::vector<LimbSection> whole_limbs(const Skeleton& skeleton, const TriMesh& skin,
                                     const Binding& binding) {
  std::vector<LimbSection> out;
  for (const auto& [name, root] : {std::array{"arm", "shoulder"}, std::array{"leg", "hip"}})
    for (const std::string side : {"_l", "_r"}) {
      const int first = find_joint(skeleton, root + side);
      if (first < 0) continue;
      std::set<int> limb{first};
      for (std::size_t j = 0; j < skeleton.joints.size(); ++j)
        if (limb.count(skeleton.joints[j].parent) > 0) limb.insert(int(j));
      out.push_back(section_of(name + side, limb, skin, binding));
    }
  for (const std::string side : {"_l", "_r"}) {
    const int upper_arm = find_joint(skeleton, "shoulder" + side);
    std::set<int> girdle{upper_arm};
    for (const char* joint : {"clavicle", "scapula"})
      girdle.insert(find_joint(skeleton, joint + side));
    girdle.erase(-1);
    if (upper_arm >= 0) out.push_back(section_of("shoulder" + side, girdle, skin, binding));
  }
  return out;
}

double section_change(const LimbSection& section, const TriMesh& rest, const SkinFrame& frame) {
  Points V;
  to_points(frame, V);
  const double before = section_volume(section, rest.F, rest.V);
  return (section_volume(section, rest.F, V) - before) / before;
}

std::vector<VolumePose> volume_poses(const Skeleton& skeleton) {
  const auto pose = [&](const char* angles) {
    return pose_of_angles(angles, skeleton, "volume_poses");
  };
  std::vector<VolumePose> out;
  out.push_back(
      {"elbow_135", "whole arm, elbow bent 135 deg", {"arm_l", "arm_r"}, 0.01, pose("elbow 135")});
  VolumePose turn{"forearm_150",
                  "whole arm, forearm turned 150 deg from rest",
                  {"arm_l", "arm_r"},
                  0.015,
                  rest_pose(skeleton)};
  for (const std::string side : {"_l", "_r"}) {
    const std::size_t j = find_joint(skeleton, "forearm" + side);
    // Inwards: the rest pose has the palms to the thighs, and the hand goes further that way.
    const double inwards = side == "_r" ? 1 : -1;
    const Vec3 along = (rest_positions(skeleton)[find_joint(skeleton, "wrist" + side)] -
                        rest_positions(skeleton)[j])
                           .normalized();
    const Vec3 axis = skeleton.joints[j].axes.col(2).dot(along) < 0
                          ? Vec3(-skeleton.joints[j].axes.col(2))
                          : Vec3(skeleton.joints[j].axes.col(2));
    turn.pose.rotations[j] = Quat(Eigen::AngleAxisd(-inwards * kForearmTurn, axis.normalized()));
  }
  out.push_back(std::move(turn));
  out.push_back({"shoulder_80",
                 "whole arm, upper arm turned in 80 deg",
                 {"arm_l", "arm_r"},
                 0.015,
                 pose("arm 0 0 -80")});
  out.push_back({"arm_180",
                 "shoulder and armpit, arm raised 180 deg",
                 {"shoulder_l", "shoulder_r"},
                 0.05,
                 pose("arm 180 45")});
  out.push_back(
      {"knee_120", "whole leg, knee bent 120 deg", {"leg_l", "leg_r"}, 0.01, pose("knee 120")});
  out.push_back({"hip_90", "whole body, hips bent 90 deg", {}, 0.005, pose("hip 90")});
  return out;
}

}  // namespace ecorche::inline v1
