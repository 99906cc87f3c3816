// Packed points of the map go where joints' motions bring them: beside the sums written out.
#include "skinning/interior/map_points.h"

#include <gtest/gtest.h>

namespace ecorche {
namespace {

MapPoint point_between(const Vec3& rest, float share) {
  MapPoint point;
  point.rest = rest;
  point.joints.count = 2;
  point.joints.source = {0, 1};
  point.joints.weight = {1 - share, share};
  point.skin.count = 1;
  point.skin.source = {2};
  point.skin.weight = {0.5f};
  point.cells = {{1, 0.25}, {3, 0.75}};
  return point;
}

TEST(MapPoints, GoWhereJointsBringThem) {
  const std::vector<Vec3> joints{{0, 1, 0}, {0.1, 1.4, 0}};
  const std::vector<int> parents{-1, 0};
  PosedAnatomy posed;
  const Quat root(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized())),
      turn(Eigen::AngleAxisd(1.3, Vec3(-1, 0.5, 2).normalized()));
  posed.X_WJ = {Transform(Eigen::Translation3d(2, 1, 5) * root),
                Transform(Eigen::Translation3d(2.1, 1.5, 5.1) * turn)};
  JointMotions motions;
  set_motions(joints, parents, posed, motions);
  const std::vector<MapPoint> some{point_between({0.05, 1.2, 0.03}, 0),
                                   point_between({0.05, 1.2, 0.03}, 1),
                                   point_between({0.02, 1.3, 0.01}, 0.3f)};
  const MapPoints points = pack_points(some);
  ASSERT_EQ(points.size(), 3u);
  const auto by_joint = [&](std::size_t j, const Vec3& rest) {
    return Vec3(posed.X_WJ[j] * (rest - joints[j]));
  };
  for (const float straight : {0.0f, 0.5f, 1.0f}) {
    EXPECT_LT((moved(motions, points, 0, straight) - by_joint(0, some[0].rest)).norm(), 1e-6);
    EXPECT_LT((moved(motions, points, 1, straight) - by_joint(1, some[1].rest)).norm(), 1e-6);
  }
  const Vec3 rest = some[2].rest, linear = 0.7 * by_joint(0, rest) + 0.3 * by_joint(1, rest);
  EXPECT_LT((moved(motions, points, 2, 1) - linear).norm(), 1e-6);
  // Dual quaternions keep turns turns: distances between points of equal weights stay.
  const std::vector<MapPoint> pair{point_between(rest, 0.3f),
                                   point_between(rest + Vec3(0.01, 0.02, -0.01), 0.3f)};
  const MapPoints near = pack_points(pair);
  const Vec3 before = pair[1].rest - pair[0].rest,
             after = moved(motions, near, 1, 0) - moved(motions, near, 0, 0);
  EXPECT_NEAR(after.norm(), before.norm(), 1e-6);
  EXPECT_LT((turned(motions, near, 0) * before - after).norm(), 1e-6);
}

TEST(MapPoints, TakeMeansOfTheirSources) {
  const MapPoints points = pack_points(std::vector{point_between({0, 0, 0}, 0.5f)});
  std::vector<float> rows(16, 0.0f);
  for (std::size_t k = 0; k < 16; ++k) rows[k] = float(k);
  EXPECT_LT((skin_mean(points, 0, rows) - Vec3(4, 4.5, 5)).norm(), 1e-6);
  EXPECT_LT((cell_mean(points, 0, rows) - Vec3(10, 11, 12)).norm(), 1e-6);
  EXPECT_NEAR(cell_value(points, 0, std::vector<float>{0, 1, 2, 3}), 2.5f, 1e-6f);
}

}  // namespace
}  // namespace ecorche
