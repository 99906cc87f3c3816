#include "skinning/center_of_mass.h"

#include <stdexcept>

namespace ecorche {

CenterOfMass::CenterOfMass(const Skeleton& skeleton) {
  const std::vector<Vec3> at = rest_positions(skeleton);
  auto index = [&](const std::string& name) {
    const int j = find_joint(skeleton, name);
    if (j < 0) throw std::invalid_argument("center of mass: our skeleton has no joint '" + name + "'");
    return j;
  };
  auto add = [&](double mass, const std::string& joint, const Vec3& place) {
    segments_.push_back({mass, index(joint), place - at[index(joint)]});
  };
  auto between = [&](const std::string& from, const std::string& to, double share) -> Vec3 {
    return at[index(from)] + share * (at[index(to)] - at[index(from)]);
  };
  // Trunk 0.431 in three: pelvis, abdomen, thorax. The head's centre lies at the ear, a head's radius over the topmost joint.
  const Vec3 head = at[index("head")], neck = at[index("c7")];
  add(0.118, "pelvis", between("pelvis", "l5", 0.6));
  add(0.155, "l2", between("l4", "t12", 0.5));
  add(0.158, "thorax", between("thorax", "c7", 0.45));
  add(0.068, "head", head + 0.25 * (head - neck) + Vec3(0, 0, 0.12 * (head - neck).norm()));
  for (const std::string s : {"_l", "_r"}) {
    add(0.026, "shoulder" + s, between("shoulder" + s, "elbow" + s, 0.577));
    add(0.015, "elbow" + s, between("elbow" + s, "wrist" + s, 0.457));
    add(0.006, "wrist" + s, between("wrist" + s, "mcp3" + s, 0.79));
    add(0.145, "hip" + s, between("hip" + s, "knee" + s, 0.385));
    add(0.046, "knee" + s, between("knee" + s, "ankle" + s, 0.442));
    add(0.0135, "subtalar" + s, between("ankle" + s, "mtp2" + s, 0.40));
  }
}

Vec3 CenterOfMass::operator()(const std::vector<Transform>& X) const {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (const Segment& segment : segments_) {
    sum += segment.mass * (X[segment.joint] * segment.place);
    mass += segment.mass;
  }
  return sum / mass;
}

}  // namespace ecorche
