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
  for (const int j : joints) out[std::size_t(j)] = joint_frame(skeleton, pose, out, std::size_t(j));
}

}  // namespace ecorche::inline v1
