// Laws of a bone's reach: a ball reaches its radius in every direction, what is too far is not
// seen, and a turned bone reaches as far in turned directions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "anatomy/muscles/bone_reach.h"

namespace ecorche {
namespace {

// Latitudes and longitudes of a ball, 0.02 m, squeezed along z.
TriMesh ball(double squeeze) {
  constexpr int kRows = 24, kColumns = 36;
  TriMesh mesh;
  mesh.V.resize((kRows + 1) * kColumns, 3);
  mesh.F.resize(2 * kRows * kColumns, 3);
  for (int r = 0; r <= kRows; ++r)
    for (int c = 0; c < kColumns; ++c) {
      const double a = std::numbers::pi * r / kRows, b = 2 * std::numbers::pi * c / kColumns;
      mesh.V.row(r * kColumns + c) << 0.02 * std::sin(a) * std::cos(b), 0.02 * std::cos(a),
          0.02 * squeeze * std::sin(a) * std::sin(b);
      if (r == kRows) continue;
      const int p = r * kColumns + c, q = r * kColumns + (c + 1) % kColumns;
      mesh.F.row(2 * (r * kColumns + c)) << p, q, q + kColumns;
      mesh.F.row(2 * (r * kColumns + c) + 1) << p, q + kColumns, p + kColumns;
    }
  return mesh;
}

TEST(BoneReach, OfABallIsItsRadius) {
  const BoneReach reach = bone_reach(ball(1), 0, Vec3(0, 1, 0), Vec3::Zero(), Vec3::UnitX(), 0.05);
  for (int i = 0; i < 500; ++i) {
    const double z = 1 - (2 * i + 1) / 500.0, r = std::sqrt(1 - z * z), turn = 2.399963 * i;
    const Eigen::Vector3f toward(float(r * std::cos(turn)), float(r * std::sin(turn)), float(z));
    EXPECT_NEAR(reach_toward(reach, 3 * toward), 0.02, 1.5e-3) << i;
  }
  EXPECT_LT((reach.centre - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6);
}

TEST(BoneReach, SeesTheFarthestWithinItsLimit) {
  const BoneReach flat = bone_reach(ball(0.5), 0, Vec3::Zero(), Vec3::Zero(), Vec3::UnitX(), 0.05);
  EXPECT_NEAR(reach_toward(flat, Eigen::Vector3f::UnitZ()), 0.01, 1e-3);
  EXPECT_NEAR(reach_toward(flat, Eigen::Vector3f::UnitY()), 0.02, 1e-3);
  const BoneReach aside =
      bone_reach(ball(1), 0, Vec3::Zero(), Vec3(0.03, 0, 0), Vec3::UnitY(), 0.02);
  EXPECT_NEAR(reach_toward(aside, -Eigen::Vector3f::UnitX()), 0.01, 1e-3)
      << "the far side is not seen";
  EXPECT_EQ(reach_toward(aside, Eigen::Vector3f::UnitX()), 0);
}

}  // namespace
}  // namespace ecorche
