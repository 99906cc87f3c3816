#include <algorithm>
#include <cmath>

#include "skinning/constraints/plant_feet.h"

namespace ecorche {

constexpr double kNearGround = 0.010;  // m: below it a point of a contact counts as planted

void measure_feet(const Skeleton& skeleton, double sole_height, const Motion& motion,
                  RetargetReport& report) {
  const std::array<FootShape, 2> shapes = {foot_shape(skeleton, Side::left, sole_height),
                                           foot_shape(skeleton, Side::right, sole_height)};
  std::array<std::vector<FootPoints>, 2> points;
  std::vector<Transform> X;
  report.penetration = 0;
  for (const Pose& pose : motion.frames) {
    forward_kinematics(skeleton, pose, X);
    for (int side = 0; side < 2; ++side) {
      points[side].push_back(foot_points(skeleton, shapes[side], X));
      const FootPoints& p = points[side].back();
      report.penetration = std::max({report.penetration, -p.heel.y(), -p.ball.y(), -p.tip.y()});
    }
  }
  std::vector<double> slides;
  for (Contact& contact : report.contacts) {
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
  report.slide_p95 =
      slides.empty() ? 0 : slides[std::min(slides.size() - 1, std::size_t(0.95 * slides.size()))];
}

}  // namespace ecorche
