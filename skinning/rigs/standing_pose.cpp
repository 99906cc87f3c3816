#include "skinning/rigs/standing_pose.h"

#include "anatomy/compute/eigenvectors.h"

namespace ecorche::inline v1 {
namespace {

// m^2: vertices spread by less about their centre leave a joint with its parent.
constexpr double kFirm = 0.004 * 0.004;

struct Moments {
  double weight = 0;
  Vec3 rest = Vec3::Zero(), standing = Vec3::Zero();
  Mat3 product = Mat3::Zero();
};

}  // namespace

Pose standing_pose(const Skeleton& skeleton, const Points& rest, const Points& standing,
                   const std::vector<JointWeights>& weights) {
  const std::size_t count = skeleton.joints.size();
  std::vector<Moments> moments(count);
  for (std::size_t i = 0; i < weights.size(); ++i)
    for (const Influence& w : weights[i]) {
      if (!(w.weight > 0)) continue;
      Moments& m = moments[std::size_t(w.joint)];
      const Vec3 from = rest.row(Eigen::Index(i)), to = standing.row(Eigen::Index(i));
      m.weight += w.weight;
      m.rest += w.weight * from;
      m.standing += w.weight * to;
      m.product += w.weight * to * from.transpose();
    }
  std::vector<Mat3> world(count);
  Pose out;
  for (std::size_t j = 0; j < count; ++j) {
    const int parent = skeleton.joints[j].parent;
    const Mat3 above = parent < 0 ? Mat3::Identity() : world[std::size_t(parent)];
    const Moments& m = moments[j];
    world[j] = above;
    if (m.weight > 1e-9)
      world[j] =
          nearest_rotation(m.product / m.weight -
                           m.standing * m.rest.transpose() / (m.weight * m.weight) + kFirm * above);
    out.rotations.push_back(Quat(Mat3(above.transpose() * world[j])).normalized());
  }
  // By the joints near the root, whose places the chain has not yet spoilt.
  out.root = rest_pose(skeleton).root;
  std::vector<Transform> X_WJ;
  forward_kinematics(skeleton, out, X_WJ);
  const std::vector<Vec3> origins = rest_positions(skeleton);
  Vec3 miss = Vec3::Zero();
  double sum = 0;
  for (std::size_t j = 0; j < count; ++j) {
    const Moments& m = moments[j];
    if (!(m.weight > 0)) continue;
    const double share = m.weight;
    miss += share * (m.standing / m.weight - X_WJ[j] * (m.rest / m.weight - origins[j]));
    sum += share;
  }
  if (sum > 0) out.root += miss / sum;
  return out;
}

}  // namespace ecorche::inline v1
