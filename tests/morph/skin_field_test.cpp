// Laws of the signed distance and the winding number, on shapes whose distance is known in closed
// form.
#include "anatomy/queries/signed_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

namespace ecorche {
namespace {

// A box with corners at +-half, 12 triangles.
TriMesh box(const Vec3& half) {
  TriMesh mesh;
  mesh.V.resize(8, 3);
  for (int i = 0; i < 8; ++i)
    mesh.V.row(i) << (i & 1 ? 1 : -1) * half.x(), (i & 2 ? 1 : -1) * half.y(),
        (i & 4 ? 1 : -1) * half.z();
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6,
      2, 1, 3, 7, 1, 7, 5;
  return mesh;
}

double box_distance(const Vec3& p, const Vec3& half) {
  const Vec3 q = p.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

// Each triangle in four, vertices shared, pushed onto the unit sphere.
TriMesh ball_skin_field(int levels) {
  TriMesh mesh = box(Vec3::Ones());
  mesh.V.rowwise().normalize();
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle;
    std::vector<Vec3> points;
    for (int i = 0; i < mesh.V.rows(); ++i) points.push_back(mesh.V.row(i));
    std::vector<Eigen::RowVector3i> faces;
    const auto mid = [&](int a, int b) {
      const auto [it, fresh] =
          middle.try_emplace({std::min(a, b), std::max(a, b)}, int(points.size()));
      if (fresh) points.push_back((points[a] + points[b]).normalized());
      return it->second;
    };
    for (int f = 0; f < mesh.F.rows(); ++f) {
      const int a = mesh.F(f, 0), b = mesh.F(f, 1), c = mesh.F(f, 2);
      const int ab = mid(a, b), bc = mid(b, c), ca = mid(c, a);
      for (const auto& t : {Eigen::RowVector3i(a, ab, ca), Eigen::RowVector3i(ab, b, bc),
                            Eigen::RowVector3i(ca, bc, c), Eigen::RowVector3i(ab, bc, ca)})
        faces.push_back(t);
    }
    mesh.V.resize(points.size(), 3);
    for (size_t i = 0; i < points.size(); ++i) mesh.V.row(i) = points[i];
    mesh.F.resize(faces.size(), 3);
    for (size_t f = 0; f < faces.size(); ++f) mesh.F.row(f) = faces[f];
  }
  return mesh;
}

TEST(SkinField, DistanceToABoxIsItsClosedForm) {
  const Vec3 half(0.3, 0.2, 0.5);
  const SkinField field(box(half));
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> u(-0.8, 0.8);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p(u(rng), u(rng), u(rng));
    EXPECT_NEAR(field.distance(p), box_distance(p, half), 1e-12);
  }
}

TEST(SkinField, GradientIsTheDerivativeOfTheDistance) {
  const SkinField field(ball_skin_field(3));
  std::mt19937 rng(8);
  std::uniform_real_distribution<double> u(-1.5, 1.5);
  int checked = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p(u(rng), u(rng), u(rng));
    const SkinPoint at = field.nearest(p);
    if (p.norm() < 0.3 || std::abs(at.distance) < 1e-3) continue;
    const double h = 1e-6;
    Vec3 g;
    for (int k = 0; k < 3; ++k)
      g[k] =
          (field.distance(p + h * Vec3::Unit(k)) - field.distance(p - h * Vec3::Unit(k))) / (2 * h);
    if ((g - at.gradient).norm() > 1e-4) continue;  // on the medial axis between two triangles
    ++checked;
  }
  EXPECT_GT(checked, 250);
}

TEST(SkinField, WindingNumberAndSignAgree) {
  const SkinField field(ball_skin_field(4));
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> u(-1.2, 1.2);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p(u(rng), u(rng), u(rng));
    const double d = field.distance(p), w = field.winding_number(p);
    EXPECT_NEAR(w, d < 0 ? 1 : 0, 0.02) << p.transpose();
  }
}

TEST(SkinField, TheSeedDoesNotChangeTheAnswer) {
  const TriMesh mesh = ball_skin_field(3);
  const SkinField field(mesh);
  std::mt19937 rng(10);
  std::uniform_real_distribution<double> u(-1.2, 1.2);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p(u(rng), u(rng), u(rng));
    const SkinPoint a = field.nearest(p), b = field.nearest(p, i % int(mesh.F.rows()));
    EXPECT_EQ(a.triangle, b.triangle);
    EXPECT_EQ(a.distance, b.distance);
  }
}

TEST(SkinField, AnOpenSkinIsRefused) {
  TriMesh mesh = box(Vec3::Ones());
  mesh.F.conservativeResize(11, 3);
  EXPECT_THROW(SkinField{mesh}, std::invalid_argument);
}

}  // namespace
}  // namespace ecorche
