#include "morph/tissue/interior_interpolation.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace ecorche {
namespace {

// A limb: points on a tube of 5 cm about +Y, and points inside it.
Points tube() {
  Points out(40 * 16, 3);
  for (int ring = 0; ring < 40; ++ring)
    for (int side = 0; side < 16; ++side) {
      const double angle = 2 * M_PI * side / 16;
      out.row(ring * 16 + side) << 0.05 * std::cos(angle), 0.012 * ring, 0.05 * std::sin(angle);
    }
  return out;
}

Points core() {
  Points out(30, 3);
  for (int i = 0; i < 30; ++i)
    out.row(i) << 0.01 * std::cos(i), 0.05 + 0.012 * i, 0.015 * std::sin(3 * i);
  return out;
}

TEST(CarryInside, AffineChangesCarryExactly) {
  const Points skin = tube(), inside = core();
  const SkinInterpolation carrier = make_skin_interpolation(skin, inside);
  Mat3 A = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  A.col(1) *= 1.2;
  A(0, 2) += 0.1;
  const Vec3 t(0.3, -0.2, 0.1);
  const auto change = [&](const Points& P) {
    return Points((P * A.transpose()).rowwise() + t.transpose());
  };
  Points moved;
  carry(carrier, change(skin), moved);
  EXPECT_LT((moved - change(inside)).rowwise().norm().maxCoeff(), 1e-6);
}

TEST(CarryInside, ASkinThatGrowsAllRoundLeavesTheAxis) {
  Points skin = tube(), axis(20, 3);
  for (int i = 0; i < 20; ++i) axis.row(i) << 0, 0.1 + 0.012 * i, 0;
  const SkinInterpolation carrier = make_skin_interpolation(skin, axis);
  for (Eigen::Index v = 0; v < skin.rows(); ++v) {
    const double swell = 1 + 0.2 * std::exp(-std::pow((skin(v, 1) - 0.2) / 0.1, 2));
    skin(v, 0) *= swell, skin(v, 2) *= swell;
  }
  Points moved;
  carry(carrier, skin, moved);
  EXPECT_LT((moved - axis).rowwise().norm().maxCoeff(), 0.002);
}

}  // namespace
}  // namespace ecorche
