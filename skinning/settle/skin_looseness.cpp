#include "skinning/settle/skin_looseness.h"

#include <algorithm>
#include <cmath>

namespace ecorche::inline v1 {
namespace {

constexpr double kMostStrain = 3;
constexpr double kLeastEdge = 1e-5;  // m

// Differences of the joint weights of an edge's ends: a vertex that follows a joint follows its
// parents, too.
class Differences {
 public:
  explicit Differences(const Skeleton& skeleton)
      : skeleton_(skeleton), difference_(skeleton.joints.size(), 0) {}

  void add(const JointWeights& weights, double sign) {
    for (const Influence& w : weights) {
      if (w.weight == 0) continue;
      for (int j = w.joint; j >= 0; j = skeleton_.joints[j].parent) {
        difference_[j] += sign * w.weight;
        met_.push_back(std::size_t(j));
      }
    }
  }

  // Calls visit(joint, |difference|), a joint once, and forgets them.
  template <class Visit>
  void take(const Visit& visit) {
    for (const std::size_t j : met_) {
      if (difference_[j] != 0) visit(j, std::abs(difference_[j]));
      difference_[j] = 0;
    }
    met_.clear();
  }

 private:
  const Skeleton& skeleton_;
  std::vector<double> difference_;
  std::vector<std::size_t> met_;
};

}  // namespace

std::vector<double> find_joint_strain(const Skeleton& skeleton, const TriMesh& skin,
                                      std::span<const JointWeights> joint_weights) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  std::vector<double> farthest;  // rad
  for (const Joint& joint : skeleton.joints)
    farthest.push_back(std::max(joint.max.cwiseAbs().maxCoeff(), joint.min.cwiseAbs().maxCoeff()));
  std::vector<double> out(joint_weights.size(), 0);
  Differences differences(skeleton);
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = skin.F(f, k), b = skin.F(f, (k + 1) % 3);
      const Vec3 middle = 0.5 * (skin.V.row(a) + skin.V.row(b));
      const double length = std::max((skin.V.row(a) - skin.V.row(b)).norm(), kLeastEdge);
      differences.add(joint_weights[a], 1);
      differences.add(joint_weights[b], -1);
      double strain = 0;
      differences.take([&](std::size_t j, double difference) {
        strain = std::max(strain, difference * farthest[j] * (middle - origins[j]).norm() / length);
      });
      for (const int v : {a, b}) out[v] = std::max(out[v], std::min(strain, kMostStrain));
    }
  return out;
}

}  // namespace ecorche::inline v1
