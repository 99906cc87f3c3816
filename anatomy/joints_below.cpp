#include "anatomy/joints_below.h"

namespace ecorche::inline v1 {

std::vector<char> joints_below(const Skeleton& skeleton, int joint) {
  std::vector<char> out(skeleton.joints.size(), 0);
  for (std::size_t j = 0; j < out.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    out[j] = int(j) == joint || (parent >= 0 && out[std::size_t(parent)]);
  }
  return out;
}

}  // namespace ecorche::inline v1
