#include "skinning/bake/bake_helpers.h"

#include <cmath>

#include <Eigen/LU>

#include "anatomy/compute/eigenvectors.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kRadius = 0.06;       // m, of a patch
constexpr double kApart = 0.10;        // m, least distance of two helpers
constexpr double kLeastWeight = 0.02;  // vertices with a smaller weight do not place the helper
// Weight of the patch beside the helper's own vertices; it keeps the fit regular where those are
// few.
constexpr double kPatch = 0.02;
constexpr int kRounds = 3;  // of alternation between the helpers

// Sums for the rigid map that brings points x closest to y.
class RigidFit {
 public:
  void add(const Vec3& x, const Vec3& y, double weight) {
    weight_ += weight;
    x_ += weight * x, y_ += weight * y;
    xy_ += weight * y * x.transpose();
  }
  bool empty() const { return weight_ <= 0; }
  Transform map() const {
    const Vec3 x = x_ / weight_, y = y_ / weight_;
    Transform out = Transform::Identity();
    out.linear() = nearest_rotation(xy_ - weight_ * y * x.transpose());
    out.translation() = y - out.linear() * x;
    return out;
  }

 private:
  double weight_ = 0;
  Vec3 x_ = Vec3::Zero(), y_ = Vec3::Zero();
  Mat3 xy_ = Mat3::Zero();
};

void add_patch(const Points& V, const HelperPatch& patch, const Rows3f& exact, double scale,
               RigidFit& fit) {
  for (const auto& [i, weight] : patch.vertices)
    fit.add(V.row(i), exact.row(i).transpose().cast<double>(), scale * weight);
}

}  // namespace

std::vector<HelperPatch> choose_helpers(const Points& V, const Eigen::VectorXd& errors,
                                        double least, int count) {
  Eigen::VectorXd left = errors;
  std::vector<HelperPatch> out;
  while (int(out.size()) < count) {
    Eigen::Index worst = 0;
    if (left.maxCoeff(&worst) < least) break;
    HelperPatch& patch = out.emplace_back();
    patch.center = int(worst);
    for (Eigen::Index i = 0; i < V.rows(); ++i) {
      const double distance = (V.row(i) - V.row(worst)).norm();
      if (distance < kRadius)
        patch.vertices.emplace_back(int(i), std::exp(-std::pow(2 * distance / kRadius, 2)));
      if (distance < kApart) left[i] = 0;
    }
  }
  return out;
}

std::vector<std::vector<int>> vertices_of_helpers(Influences influences, std::size_t joints,
                                                  std::size_t helpers) {
  std::vector<std::vector<int>> out(helpers);
  for (std::size_t i = 0; i < influences.size(); ++i)
    for (const Influence& influence : influences[i])
      if (influence.weight > kLeastWeight && std::size_t(influence.joint) >= joints)
        out[influence.joint - joints].push_back(int(i));
  return out;
}

void pose_helpers(const Points& V, std::span<const HelperPatch> patches,
                  std::span<const std::vector<int>> skinned, Influences influences,
                  BakeFrame& frame) {
  const std::size_t joints = frame.bones.size() - patches.size();
  for (std::size_t h = 0; h < patches.size(); ++h) {
    RigidFit fit;
    add_patch(V, patches[h], frame.exact, 1, fit);
    frame.bones[joints + h] = fit.map();
  }
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t h = 0; h < patches.size(); ++h) {
      RigidFit fit;
      for (const int i : skinned[h]) {
        const Vec3 x = V.row(i);
        Vec3 rest = frame.exact.row(i).transpose().cast<double>();
        double share = 0;
        for (const Influence& influence : influences[i]) {
          if (influence.weight <= 0) continue;
          const std::size_t bone = influence.joint;
          if (bone == joints + h)
            share += influence.weight;
          else
            rest -= influence.weight * (frame.bones[bone] * x);
        }
        fit.add(x, rest / share, share * share);
      }
      add_patch(V, patches[h], frame.exact, kPatch, fit);
      frame.bones[joints + h] = fit.map();
    }
}

}  // namespace ecorche::inline v1
