// The exact search against a search over everything.
#include "anatomy/queries/nearest_surface.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

TEST(NearestSurface, EqualsASearchOverAllTriangles) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  TriMesh soup;
  soup.V.resize(900, 3);
  soup.F.resize(300, 3);
  for (Eigen::Index i = 0; i < soup.V.rows(); ++i) {
    const Vec3 center =
        i % 3 == 0 ? Vec3(unit(random), unit(random), unit(random)) : Vec3(soup.V.row(i - i % 3));
    soup.V.row(i) = center + 0.1 * Vec3(unit(random), unit(random), unit(random));
    soup.F.data()[i] = int(i);
  }
  const NearestSurface surface(soup);
  for (int q = 0; q < 400; ++q) {
    const Vec3 p(1.5 * unit(random), 1.5 * unit(random), 1.5 * unit(random));
    double best = 1e9;
    for (Eigen::Index f = 0; f < soup.F.rows(); ++f) {
      // By brute sampling-free means: the nearest of the plane's foot (if inside) and the three
      // edges.
      const Vec3 a = soup.V.row(soup.F(f, 0)), b = soup.V.row(soup.F(f, 1)),
                 c = soup.V.row(soup.F(f, 2));
      const auto edge = [&](const Vec3& u, const Vec3& v) {
        const double t = std::clamp((p - u).dot(v - u) / (v - u).squaredNorm(), 0.0, 1.0);
        return (p - u - t * (v - u)).norm();
      };
      best = std::min({best, edge(a, b), edge(b, c), edge(c, a)});
      const Vec3 n = (b - a).cross(c - a).normalized(), foot = p - n * n.dot(p - a);
      if ((b - a).cross(foot - a).dot(n) >= 0 && (c - b).cross(foot - b).dot(n) >= 0 &&
          (a - c).cross(foot - c).dot(n) >= 0)
        best = std::min(best, std::abs(n.dot(p - a)));
    }
    const SurfacePoint hit = surface.nearest(p);
    EXPECT_NEAR(hit.distance, best, 1e-9);
    EXPECT_NEAR((hit.point - p).norm(), hit.distance, 1e-12);
    const SurfacePoint hinted = surface.nearest(p, q % 300);
    EXPECT_EQ(hinted.triangle, hit.triangle);
    EXPECT_EQ(hinted.distance, hit.distance);
    const std::optional<SurfacePoint> within = surface.nearest_within(p, 0.15);
    ASSERT_EQ(within.has_value(), hit.distance <= 0.15);
    if (within) EXPECT_EQ(within->triangle, hit.triangle);
  }
}

TEST(NearestSurface, FindsPlacesOnTrianglesWithoutArea) {
  const Vec3 a(0, 0, 0), b(1, 0, 0);
  for (const auto& [p, nearest] :
       {std::pair(Vec3(2, 1, 0), b), {Vec3(-1, 1, 0), a}, {Vec3(0.25, -1, 0), Vec3(0.25, 0, 0)}})
    for (const auto& [u, v, w] : {std::tuple(a, b, b), {b, a, b}, {b, b, a}, {a, a, b}})
      EXPECT_LT((nearest_in_triangle(p, u, v, w) - nearest).norm(), 1e-12)
          << p.transpose() << " of " << u.x() << v.x() << w.x();
  EXPECT_EQ(nearest_in_triangle(Vec3(1, 2, 3), b, b, b), b);
}

TEST(NearestSurface, RaysAndSegmentsMeetTheSphere) {
  const TriMesh ball = test::capsule(Vec3(0, -1e-4, 0), Vec3(0, 1e-4, 0), 0.5, 64);
  const NearestSurface surface(ball);
  const auto hit = surface.cast(Vec3::Zero(), Vec3::UnitX());
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(*hit, 0.5, 0.01);
  EXPECT_FALSE(surface.cast(Vec3(2, 0, 0), Vec3::UnitX()).has_value());
  EXPECT_TRUE(surface.blocked(Vec3::Zero(), Vec3(1, 0, 0)));
  EXPECT_FALSE(surface.blocked(Vec3::Zero(), Vec3(0.3, 0.1, 0)));
}

TEST(NearestSurface, RefusesBrokenMeshes) {
  EXPECT_THROW(NearestSurface{TriMesh{}}, std::invalid_argument);
  TriMesh mesh = test::capsule(Vec3::Zero(), Vec3::UnitX(), 0.1);
  mesh.F(0, 0) = 100000;
  EXPECT_THROW(NearestSurface{mesh}, std::invalid_argument);
}

}  // namespace
}  // namespace ecorche
