#include "skinning/bake/bake_samples.h"

namespace ecorche::inline v1 {

std::vector<Transform> rest_to_pose(const std::vector<Vec3>& origins,
                                    std::span<const Transform> X_WJ) {
  std::vector<Transform> out(X_WJ.begin(), X_WJ.end());
  for (std::size_t j = 0; j < out.size(); ++j) out[j].translate(-origins[j]);
  return out;
}

}  // namespace ecorche::inline v1
