#include "skinning/settle/fold_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "anatomy/compute/smooth_step.h"
#include "skinning/settle/weights_below.h"

namespace ecorche::inline v1 {
namespace {

constexpr FoldParameters kParametersFold;

// Mean tissue over the flexor side of a segment, from a tenth to a half of its length.
class FlexorTissue {
 public:
  void add(double along, double flexor, double aside, double tissue) {
    if (along < 0.1 || along > 0.5 || flexor < std::abs(aside)) return;
    sum_ += tissue;
    ++count_;
  }
  double mean() const { return count_ > 0 ? sum_ / count_ : 0; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

HingeFold make_hinge(const Skeleton& skeleton, const std::vector<Vec3>& origins, int joint, int end,
                     std::span<const Vec3> rest, std::span<const JointWeights> joint_weights,
                     std::span<const double> tissue) {
  HingeFold out;
  out.distal = joint;
  out.proximal = skeleton.joints[joint].parent;
  const Vec3 center = origins[joint], up = origins[out.proximal] - center,
             down = origins[end] - center;
  out.up = up.normalized();
  out.down = down.normalized();
  const Vec3 across = (out.down - out.up).normalized();
  const Vec3 axis = skeleton.joints[joint].axes.col(0);
  const std::vector<double> limb = weights_below(skeleton, out.proximal, joint_weights),
                            beyond = weights_below(skeleton, end, joint_weights);
  std::array<FlexorTissue, 2> flesh;  // proximal, distal
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (limb[i] - beyond[i] < 0.5) continue;
    const Vec3 from = rest[i] - center;
    const bool distal = across.dot(from) > 0;
    const Vec3& segment = distal ? down : up;
    const double along = from.dot(segment) / segment.squaredNorm();
    if (along > 1) continue;
    const Vec3 flexor = axis.cross(distal ? out.down : Vec3(-out.up)).normalized();
    flesh[distal].add(along, flexor.dot(from - along * segment), axis.dot(from - along * segment),
                      tissue[i]);
    out.vertices.push_back(int(i));
    out.side.push_back(distal ? 1.0f : -1.0f);
    out.most.push_back(float(kParametersFold.most_of_tissue * tissue[i]));
  }
  const double all = flesh[0].mean() + flesh[1].mean();
  if (all > 0) out.distal_share = std::clamp(flesh[1].mean() / all, 0.2, 0.8);
  return out;
}

}  // namespace

std::vector<HingeFold> make_fold_planes(const Skeleton& skeleton, std::span<const Vec3> rest,
                                        std::span<const JointWeights> joint_weights,
                                        std::span<const double> tissue) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  std::vector<HingeFold> out;
  for (const auto& [hinge, end] : {std::array{"elbow", "wrist"}, std::array{"knee", "ankle"}})
    for (const std::string side : {"_l", "_r"}) {
      const int joint = find_joint(skeleton, hinge + side), last = find_joint(skeleton, end + side);
      if (joint < 0 || last < 0 || skeleton.joints[joint].parent < 0) continue;
      const Joint& j = skeleton.joints[joint];
      if ((j.max - j.min).x() < kParametersFold.least_range) continue;
      out.push_back(make_hinge(skeleton, origins, joint, last, rest, joint_weights, tissue));
    }
  return out;
}

void press_folds(std::span<const HingeFold> hinges, std::span<const Transform> X_WJ,
                 RelaxedSkin& skin, std::vector<float>& moved) {
  moved.assign(skin.positions.size() / 4, 0);
  for (const HingeFold& hinge : hinges) {
    const Vec3 up = X_WJ[hinge.proximal].linear() * hinge.up,
               down = X_WJ[hinge.distal].linear() * hinge.down;
    const double wedge = std::acos(std::clamp(up.dot(down), -1.0, 1.0));
    const double hold = 1 - smooth_step(kParametersFold.holds, kParametersFold.begins, wedge);
    if (hold <= 0 || wedge < 1e-3) continue;
    const double fill = 1 - smooth_step(kParametersFold.fills, kParametersFold.fill_begins, wedge);
    // From `down` to `up` by the distal segment's share of the angle.
    const double angle = hinge.distal_share * wedge;
    const Vec3 along = (std::sin(wedge - angle) * down + std::sin(angle) * up) / std::sin(wedge);
    const Vec3 across = (down - down.dot(along) * along).normalized();
    const Vec3 center = X_WJ[hinge.distal].translation();
    for (std::size_t k = 0; k < hinge.vertices.size(); ++k) {
      const std::size_t at = 4 * std::size_t(hinge.vertices[k]);
      float* p = &skin.positions[at];
      const Vec3 from = Vec3(p[0], p[1], p[2]) - center;
      const double out = along.dot(from);
      double near = hold * smooth_step(0, kParametersFold.near_hinge, out);
      if (near <= 0) continue;
      const double depth = kParametersFold.half_gap - hinge.side[k] * across.dot(from);
      if (depth < 0)
        near *= fill * (1 - smooth_step(0, kParametersFold.filled_along, out)) *
                (1 - smooth_step(0, kParametersFold.filled, -depth));
      const double most = hinge.most[k], push = std::clamp(near * depth, -most, most);
      const Vec3 way = hinge.side[k] * push * across;
      for (int c = 0; c < 3; ++c) p[c] += float(way[c]);
      moved[hinge.vertices[k]] = float(std::abs(push));
    }
  }
}

}  // namespace ecorche::inline v1
