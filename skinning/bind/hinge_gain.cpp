#include "skinning/bind/hinge_gain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "skinning/bind/blend_frames.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kBend = 2 * std::numbers::pi / 3;  // rad, at which volumes are compared
constexpr double kMostGain = 2;
// Fraction of the section's volume that a bend may lose. Smaller: knee and elbow are rounded off.
constexpr double kLossLeft = 0.015;

double segment_angle(const std::vector<Transform>& X, int upper, int middle, int lower) {
  const Vec3 a = X[std::size_t(middle)].translation() - X[std::size_t(upper)].translation();
  const Vec3 b = X[std::size_t(lower)].translation() - X[std::size_t(middle)].translation();
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0));
}

// The rest pose with one hinge turned so that its segments enclose kBend.
std::vector<Transform> bent_frames(const Skeleton& skeleton, int middle, int lower) {
  Pose pose = rest_pose(skeleton);
  std::vector<Transform> X, other;
  forward_kinematics(skeleton, pose, X);
  const int upper = skeleton.joints[middle].parent;
  const double turn = kBend - segment_angle(X, upper, middle, lower);
  const Vec3 axis = skeleton.joints[middle].axes.col(0);
  const auto bend = [&](double angle, std::vector<Transform>& out) {
    pose.rotations[middle] = Quat(Eigen::AngleAxisd(angle, axis));
    complete_pose(skeleton, pose);
    forward_kinematics(skeleton, pose, out);
    return std::abs(segment_angle(out, upper, middle, lower) - kBend);
  };
  const double forward = bend(turn, X), backward = bend(-turn, other);
  return forward <= backward ? X : other;
}

// Vertices of a section in a pose, with the pairs' weights times `gain`.
void place_section(const LimbSection& section, const TriMesh& skin, const FrameTables& tables,
                   const std::vector<WeightRow>& rows, const std::vector<float>& maps, double gain,
                   Points& V) {
  const int first_pair = tables.first_pair();
  for (int f : section.triangles)
    for (int k = 0; k < 3; ++k) {
      const int i = skin.F(f, k);
      Eigen::Matrix4f map = Eigen::Matrix4f::Zero();
      for (const Influence& w : rows[i])
        map += float(w.joint >= first_pair ? gain * w.weight : w.weight) *
               Eigen::Map<const Eigen::Matrix4f>(&maps[16 * w.joint]);
      const Vec3 X = Vec3(skin.V.row(i)) - tables.origins[0];
      V.row(i) =
          (map.topLeftCorner<3, 3>().cast<double>() * X + map.topRightCorner<3, 1>().cast<double>())
              .transpose();
    }
}

}  // namespace

std::map<int, double> find_hinge_gains(const Skeleton& skeleton, const TriMesh& skin,
                                       const std::vector<LimbSection>& sections,
                                       const FrameTables& tables,
                                       const std::vector<WeightRow>& rows) {
  std::map<int, double> gains;
  FrameWorkspace frames;
  Points V(skin.V.rows(), 3);
  for (const LimbSection& section : sections) {
    const int middle = find_joint(skeleton, section.name);
    const bool arm = section.name.starts_with("elbow");
    const int lower = find_joint(
        skeleton, (arm ? "wrist" : "ankle") + section.name.substr(section.name.size() - 2));
    if (middle < 0 || lower < 0 || section.triangles.empty()) continue;
    pose_blend_frames(tables, bent_frames(skeleton, middle, lower), frames);
    const double rest = section_volume(section, skin.F, skin.V);
    place_section(section, skin, tables, rows, frames.maps, 1, V);
    const double once = section_volume(section, skin.F, V);
    place_section(section, skin, tables, rows, frames.maps, 2, V);
    const double twice = section_volume(section, skin.F, V);
    const double gain = twice > once ? 1 + ((1 - kLossLeft) * rest - once) / (twice - once) : 1;
    gains[middle] = std::clamp(gain, 1.0, kMostGain);
    const int patella =
        find_joint(skeleton, "patella" + section.name.substr(section.name.size() - 2));
    if (!arm && patella >= 0) gains[patella] = gains[middle];  // it turns with the knee
  }
  return gains;
}

void apply_hinge_gains(const FrameTables& tables, const std::map<int, double>& gains,
                       std::vector<WeightRow>& rows) {
  const int first_pair = tables.first_pair();
  for (WeightRow& row : rows)
    for (Influence& w : row) {
      if (w.joint < first_pair) continue;
      const auto gain = gains.find(tables.pairs[w.joint - first_pair].hinge);
      if (gain != gains.end()) w.weight *= gain->second;
    }
}

}  // namespace ecorche::inline v1
