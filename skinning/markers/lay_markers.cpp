#include "skinning/markers/lay_markers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "anatomy/errors.h"
#include "anatomy/joint_angles.h"
#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMarkerRadius = 0.010;   // m, with what it is stuck on
constexpr double kWithoutSkin = 0.045;    // m
constexpr double kTableStature = 1.75;    // m
constexpr double kHeadOverJoint = 0.155;  // m, of kTableStature: vertex over the head's joint

int known_joint(const Skeleton& skeleton, const std::string& name, const MarkerPlace& place) {
  const int j = find_joint(skeleton, name);
  if (j < 0)
    throw InputError(fmt::format("marker place '{}': no joint '{}'; data/joints.csv lists them",
                                 place.name, name));
  return j;
}

}  // namespace

Pose attention_pose(const Skeleton& skeleton) {
  constexpr std::array<const char*, 8> kLimbs = {"shoulder", "elbow", "forearm", "wrist",
                                                 "hip",      "knee",  "ankle",   "subtalar"};
  Pose out = rest_pose(skeleton);
  for (const char* limb : kLimbs)
    for (const char* side : {"_l", "_r"}) {
      const int j = find_joint(skeleton, std::string(limb) + side);
      if (j >= 0) out.rotations[j] = joint_rotation(skeleton.joints[j], Vec3::Zero());
    }
  return out;
}

std::vector<BodyMarker> lay_markers(const MarkerTables& tables, const MarkerTake& take,
                                    const Skeleton& skeleton, const TriMesh& skin) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  std::vector<Transform> X;
  forward_kinematics(skeleton, attention_pose(skeleton), X);
  double low = 0, high = 0;
  for (const Vec3& joint : rest) low = std::min(low, joint.y()), high = std::max(high, joint.y());
  const double size = (high - low) / (kTableStature - kHeadOverJoint);
  std::optional<NearestSurface> surface;
  if (skin.F.rows() > 0) surface.emplace(skin);
  const std::vector<const MarkerPlace*> places = find_marker_places(tables, take.markers);
  std::vector<BodyMarker> out;
  for (std::size_t m = 0; m < places.size(); ++m) {
    if (!places[m]) continue;
    const MarkerPlace& place = *places[m];
    BodyMarker marker{take.markers[m], place.name, int(m)};
    marker.joint = known_joint(skeleton, place.joint, place);
    marker.spread = place.spread;
    const Mat3 back = X[marker.joint].linear().transpose();
    Vec3 p = rest[known_joint(skeleton, place.at, place)];
    if (!place.toward.empty())
      p += place.share * (rest[known_joint(skeleton, place.toward, place)] - p);
    p += size * (back * place.offset);
    if (!place.out.isZero()) {
      const Vec3 out_of = (back * place.out).normalized();
      const std::optional<double> way = surface ? surface->cast(p, out_of) : std::nullopt;
      p += (way.value_or(kWithoutSkin) + kMarkerRadius) * out_of;
    }
    marker.local = p - rest[marker.joint];
    marker.height = (X[marker.joint] * marker.local - X[0].translation()).y();
    out.push_back(std::move(marker));
  }
  return out;
}

}  // namespace ecorche::inline v1
