// Rays that list what they cross, against every triangle tried one by one.
#include "anatomy/queries/ray_crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "tests/morph/shapes.h"

namespace ecorche {
namespace {

struct Scene {
  TriMesh mesh;
  std::vector<int> labels;

  void add(TriMesh part, const Vec3& at, int label) {
    const Eigen::Index v = mesh.V.rows(), f = mesh.F.rows();
    part.V.rowwise() += at.transpose();
    mesh.V.conservativeResize(v + part.V.rows(), 3);
    mesh.V.bottomRows(part.V.rows()) = part.V;
    mesh.F.conservativeResize(f + part.F.rows(), 3);
    mesh.F.bottomRows(part.F.rows()) = (part.F.array() + int(v)).matrix();
    labels.resize(mesh.F.rows(), label);
  }
};

// Four rods, the second through the first, the third inside the fourth.
Scene rods() {
  Scene scene;
  scene.add(cylinder(0.05, -0.2, 0.2, 24, 6), Vec3(0, 0, 0), 0);
  scene.add(cylinder(0.04, -0.15, 0.25, 20, 5), Vec3(0.06, 0, 0.01), 1);
  scene.add(cylinder(0.01, -0.1, 0.1, 12, 4), Vec3(0.2, 0, 0), 2);
  scene.add(cylinder(0.03, -0.2, 0.2, 16, 4), Vec3(0.2, 0, 0.005), 3);
  return scene;
}

// Moeller and Trumbore's solution by Cramer's rule, in double precision.
std::vector<Crossing> by_hand(const Scene& scene, const Vec3& origin, const Vec3& direction,
                              double far, int skip) {
  std::vector<Crossing> out;
  for (int f = 0; f < scene.mesh.F.rows(); ++f) {
    if (scene.labels[f] == skip) continue;
    const Vec3 a = scene.mesh.V.row(scene.mesh.F(f, 0)), b = scene.mesh.V.row(scene.mesh.F(f, 1)),
               c = scene.mesh.V.row(scene.mesh.F(f, 2));
    Mat3 system;
    system << b - a, c - a, -direction;
    const Vec3 x = system.partialPivLu().solve(origin - a);
    if (x[0] < 0 || x[1] < 0 || x[0] + x[1] > 1 || x[2] < 0 || x[2] > far) continue;
    out.push_back({float(x[2]), f, (b - a).cross(c - a).dot(direction) < 0});
  }
  std::sort(out.begin(), out.end(),
            [](const Crossing& a, const Crossing& b) { return a.distance < b.distance; });
  return out;
}

void compare(const Scene& scene, const CrossingRays& rays) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.1, 0.3), way(-1, 1);
  std::vector<Crossing> found;
  int crossings = 0;
  for (int n = 0; n < 3000; ++n) {
    const Vec3 origin(place(random), 0.5 * way(random) * 0.2, 0.2 * way(random)),
        direction = Vec3(way(random), way(random), way(random)).normalized();
    const int skip = n % 5 - 1;
    const std::vector<Crossing> wanted = by_hand(scene, origin, direction, 0.15, skip);
    rays.cross(origin, direction, 0.15, 1e3, skip, found);
    ASSERT_EQ(found.size(), wanted.size()) << "ray " << n;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_EQ(found[i].triangle, wanted[i].triangle);
      EXPECT_EQ(found[i].entering, wanted[i].entering);
      EXPECT_NEAR(found[i].distance, wanted[i].distance, 1e-6);
    }
    crossings += wanted.size();
  }
  EXPECT_GT(crossings, 800);
}

TEST(CrossingRays, ListWhatTheyCross) {
  const Scene scene = rods();
  compare(scene, CrossingRays(scene.mesh.V, scene.mesh.F, scene.labels, scene.mesh.V.rows()));
}

TEST(CrossingRays, FollowTheMovedSurface) {
  Scene scene = rods();
  CrossingRays rays(scene.mesh.V, scene.mesh.F, scene.labels, scene.mesh.V.rows());
  scene.mesh.V =
      (scene.mesh.V * Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix())
          .rowwise() +
      Vec3(0.03, -0.02, 0.01).transpose();
  rays.move(scene.mesh.V);
  compare(scene, rays);
}

TEST(CrossingRays, LeaveAloneWhatDoesNotMove) {
  Scene scene = rods();
  const Eigen::Index moving =
      cylinder(0.05, -0.2, 0.2, 24, 6).V.rows() + cylinder(0.04, -0.15, 0.25, 20, 5).V.rows();
  CrossingRays rays(scene.mesh.V, scene.mesh.F, scene.labels, moving);
  compare(scene, rays);
  scene.mesh.V.topRows(moving).rowwise() += Vec3(0.04, -0.03, 0.02).transpose();
  rays.move(scene.mesh.V.topRows(moving));
  compare(scene, rays);
}

TEST(CrossingRays, EndWhereSomethingBeginsBeyondEnough) {
  const Scene scene = rods();
  const CrossingRays rays(scene.mesh.V, scene.mesh.F, scene.labels, scene.mesh.V.rows());
  const std::vector<Crossing> all = by_hand(scene, Vec3(-0.1, 0.01, 0.002), Vec3::UnitX(), 1, -1);
  std::vector<Crossing> found;
  rays.cross(Vec3(-0.1, 0.01, 0.002), Vec3::UnitX(), 1, 0.2, -1, found);
  const auto last = std::find_if(all.begin(), all.end(),
                                 [](const Crossing& c) { return c.entering && c.distance > 0.2f; });
  ASSERT_NE(last, all.end());
  ASSERT_EQ(found.size(), std::size_t(last - all.begin()) + 1);
  EXPECT_EQ(found.back().triangle, last->triangle);
}

TEST(CrossingRays, TellWhereEachSolidBeginsAndEnds) {
  const Scene scene = rods();
  const CrossingRays rays(scene.mesh.V, scene.mesh.F, scene.labels, scene.mesh.V.rows());
  std::vector<Crossing> found;
  std::vector<RayInterval> stays;
  rays.cross(Vec3(0, 0.01, 0.002), Vec3::UnitX(), 0.2, 1e3, -1, found);
  find_intervals(found, scene.labels, 0.2, stays);
  ASSERT_EQ(stays.size(), 4u);
  EXPECT_EQ(stays[0].solid, 1);
  EXPECT_NEAR(stays[0].from, 0.02, 2e-3);
  EXPECT_NEAR(stays[0].to, 0.1, 2e-3);
  EXPECT_EQ(stays[1].solid, 0);  // found out when it is left
  EXPECT_EQ(stays[1].from, 0);
  EXPECT_NEAR(stays[1].to, 0.05, 2e-3);
  EXPECT_EQ(stays[2].solid, 3);
  EXPECT_EQ(stays[2].to, 0.2);
  EXPECT_EQ(stays[3].solid, 2);
  EXPECT_EQ(stays[3].depth, 1);
}

TEST(CrossingRays, TellWhatIsWrong) {
  const Scene scene = rods();
  EXPECT_THROW(CrossingRays(scene.mesh.V, scene.mesh.F, {}, scene.mesh.V.rows()),
               std::invalid_argument);
  CrossingRays rays(scene.mesh.V, scene.mesh.F, scene.labels, scene.mesh.V.rows());
  EXPECT_THROW(rays.move(scene.mesh.V.topRows(3)), std::invalid_argument);
  EXPECT_THROW(CrossingRays(scene.mesh.V, scene.mesh.F, scene.labels, 0), std::invalid_argument);
  EXPECT_THROW(CrossingRays(scene.mesh.V, scene.mesh.F, scene.labels, 5),
               std::invalid_argument);  // in the midst of a rod
}

}  // namespace
}  // namespace ecorche
