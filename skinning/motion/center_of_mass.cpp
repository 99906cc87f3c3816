#include "skinning/motion/center_of_mass.h"

#include <stdexcept>

#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {

CenterOfMass::CenterOfMass(const Skeleton& skeleton) {
  const std::vector<Vec3> at = rest_positions(skeleton);
  auto index = [&](const std::string& name) { return joint_of(skeleton, name); };
  auto add = [&](double mass, const std::string& joint, const Vec3& place) {
    segments_.push_back({mass, index(joint), place - at[index(joint)]});
  };
  auto between = [&](const std::string& from, const std::string& to, double share) -> Vec3 {
    return at[index(from)] + share * (at[index(to)] - at[index(from)]);
  };
  const Vec3 head = at[index("head")], neck = at[index("c7")];
  add(0.142, "pelvis", between("pelvis", "l5", 0.6));
  add(0.139, "l2", between("l4", "t12", 0.6));
  add(0.216, "thorax", between("thorax", "c7", 0.6));
  add(0.081, "head", head + 0.4 * (head - neck));
  for (const std::string s : {"_l", "_r"}) {
    add(0.028, "shoulder" + s, between("shoulder" + s, "elbow" + s, 0.436));
    add(0.016, "elbow" + s, between("elbow" + s, "wrist" + s, 0.430));
    add(0.006, "wrist" + s, between("wrist" + s, "mcp3" + s, 0.8));
    add(0.100, "hip" + s, between("hip" + s, "knee" + s, 0.433));
    add(0.0465, "knee" + s, between("knee" + s, "ankle" + s, 0.433));
    add(0.0145, "subtalar" + s, between("ankle" + s, "mtp2" + s, 0.45));
  }
}

Vec3 CenterOfMass::operator()(const std::vector<Transform>& X) const {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (const Segment& segment : segments_) {
    sum += segment.mass * (X[segment.joint] * segment.centre);
    mass += segment.mass;
  }
  return sum / mass;
}

}  // namespace ecorche::inline v1
