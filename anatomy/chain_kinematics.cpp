#include "anatomy/chain_kinematics.h"

#include <cstddef>

namespace ecorche::inline v1 {

std::vector<int> joints_up_from(const Skeleton& skeleton, const std::vector<int>& joints) {
  std::vector<char> wanted(skeleton.joints.size(), 0);
  for (const int joint : joints)
    for (int j = joint; j >= 0; j = skeleton.joints[std::size_t(j)].parent)
      wanted[std::size_t(j)] = 1;
  std::vector<int> out;
  for (std::size_t j = 0; j < wanted.size(); ++j)
    if (wanted[j] != 0) out.push_back(int(j));
  return out;
}

void chain_kinematics(const Skeleton& skeleton, const std::vector<int>& joints, const Pose& pose,
                      std::vector<Transform>& out) {
  out.resize(skeleton.joints.size());
  for (const int number : joints) {
    const std::size_t j = std::size_t(number);
    const Joint& joint = skeleton.joints[j];
    Transform local = Transform::Identity();
    local.linear() = pose.rotations[j].toRotationMatrix();
    local.translation() = joint.parent < 0 ? pose.root : Vec3(joint.X_PJ.translation());
    out[j] = joint.parent < 0 ? local : out[std::size_t(joint.parent)] * local;
  }
}

}  // namespace ecorche::inline v1
