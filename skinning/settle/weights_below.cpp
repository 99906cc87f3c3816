#include "skinning/settle/weights_below.h"

#include "anatomy/joints_below.h"

namespace ecorche::inline v1 {

std::vector<double> weights_below(const Skeleton& skeleton, int joint,
                                  std::span<const JointWeights> joint_weights) {
  const std::vector<char> below = joints_below(skeleton, joint);
  std::vector<double> out;
  for (const auto& four : joint_weights) {
    double share = 0;
    for (const Influence& w : four) share += below[w.joint] ? w.weight : 0;
    out.push_back(share);
  }
  return out;
}

}  // namespace ecorche::inline v1
