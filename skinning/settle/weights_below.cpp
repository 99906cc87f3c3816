#include "skinning/settle/weights_below.h"

namespace ecorche::inline v1 {

std::vector<double> weights_below(const Skeleton& skeleton, int joint,
                                  std::span<const JointWeights> joint_weights) {
  std::vector<char> below(skeleton.joints.size(), 0);
  for (std::size_t j = 0; j < below.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    below[j] = int(j) == joint || (parent >= 0 && below[parent]);
  }
  std::vector<double> out;
  for (const auto& four : joint_weights) {
    double share = 0;
    for (const Influence& w : four) share += below[w.joint] ? w.weight : 0;
    out.push_back(share);
  }
  return out;
}

}  // namespace ecorche::inline v1
