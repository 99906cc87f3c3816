#include "skinning/constraints/measure_feet.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anatomy/chain_kinematics.h"
#include "skinning/constraints/foot_contacts.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kNearGround = 0.010;  // m: below it a point of a contact counts as planted

}  // namespace

FootMeasures measure_feet(const Skeleton& skeleton, double sole_height, const Motion& motion,
                          std::vector<Contact>& contacts) {
  const std::array<FootShape, 2> shapes = {foot_shape(skeleton, Side::left, sole_height),
                                           foot_shape(skeleton, Side::right, sole_height)};
  const std::vector<int> joints = feet_joints(skeleton);
  std::array<std::vector<FootPoints>, 2> points;
  std::vector<Transform> X;
  FootMeasures out;
  for (const Pose& pose : motion.frames) {
    chain_kinematics(skeleton, joints, pose, X);
    for (int side = 0; side < 2; ++side) {
      points[side].push_back(foot_points(skeleton, shapes[side], X));
      const FootPoints& p = points[side].back();
      out.penetration = std::max({out.penetration, -p.heel.y(), -p.ball.y(), -p.tip.y()});
    }
  }
  std::vector<double> slides;
  for (Contact& contact : contacts) {
    const auto& track = points[contact.side == Side::left ? 0 : 1];
    std::vector<Vec3> near;
    for (int f = contact.begin; f < contact.end; ++f) {
      const Vec3& p = contact.heel ? track[f].heel : track[f].ball;
      if (p.y() < kNearGround) near.push_back(p);
    }
    contact.slide = 0;
    for (const Vec3& a : near)
      for (const Vec3& b : {near.front(), near[near.size() / 2], near.back()})
        contact.slide = std::max(contact.slide, std::hypot(a.x() - b.x(), a.z() - b.z()));
    if (!near.empty()) slides.push_back(contact.slide);
  }
  std::sort(slides.begin(), slides.end());
  out.slide_p95 =
      slides.empty() ? 0 : slides[std::min(slides.size() - 1, std::size_t(0.95 * slides.size()))];
  return out;
}

}  // namespace ecorche::inline v1
