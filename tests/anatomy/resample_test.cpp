#include "anatomy/authoring/muscle_ends.h"
#include "anatomy/authoring/resample_mesh.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "anatomy/errors.h"
#include "anatomy/geometry/ellipse_fit.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "anatomy/muscles/action_line.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

TEST(EllipseFit, GivesBackAnEllipseFromAnArcOfIt) {
  const double angle = 0.6, a = 3, b = 1.2;
  std::vector<Vec2> points;
  for (int k = 0; k < 12; ++k) {
    const double t = 0.35 * k;  // two thirds of the way round
    const Vec2 p(a * std::cos(t), b * std::sin(t));
    points.push_back(Vec2(100, -50) + Eigen::Rotation2Dd(angle) * p);
  }
  const auto fitted = fit_ellipse(points);
  ASSERT_TRUE(fitted);
  EXPECT_LT((fitted->center - Vec2(100, -50)).norm(), 1e-6);
  EXPECT_LT((fitted->radii - Vec2(a, b)).norm(), 1e-6);
  EXPECT_NEAR(std::abs(std::sin(fitted->angle - angle)), 0, 1e-6);
}

TEST(EllipseFit, NoiseStaysAnEllipse) {
  std::vector<Vec2> points;
  for (int k = 0; k < 40; ++k)
    points.emplace_back(2 * std::cos(k) + 0.2 * std::sin(31.0 * k),
                        std::sin(k) + 0.2 * std::cos(17.0 * k));
  const auto fitted = fit_ellipse(points);
  ASSERT_TRUE(fitted);
  EXPECT_LT((fitted->radii - Vec2(2, 1)).norm(), 0.2);
}

TEST(EllipseFit, RefusesLinesAndPoints) {
  EXPECT_FALSE(fit_ellipse(std::vector<Vec2>(9, Vec2(1, 2))));
  std::vector<Vec2> line;
  for (int k = 0; k < 9; ++k) line.emplace_back(k, 2.0 * k);
  EXPECT_FALSE(fit_ellipse(line));
  EXPECT_FALSE(fit_ellipse(std::vector<Vec2>{{0, 0}, {1, 0}, {0, 1}, {1, 1}}));
}

TEST(BezierFit, ReproducesABezier) {
  const Bezier truth{{{0, 0, 0}, {1, 2, 0}, {3, -1, 1}, {4, 0, 0}}};
  std::vector<Vec3> points;
  for (int k = 0; k <= 40; ++k) points.push_back(bezier_point(truth, k / 40.0));
  const Bezier fitted = fit_bezier(points, 5);
  for (const double t : bezier_parameters(truth, std::vector<double>{0, 0.2, 0.5, 0.8, 1})) {
    double nearest = 1e9;
    for (int k = 0; k <= 2000; ++k)
      nearest =
          std::min(nearest, (bezier_point(fitted, k / 2000.0) - bezier_point(truth, t)).norm());
    EXPECT_LT(nearest, 0.02);
  }
  EXPECT_NEAR(bezier_length(fitted), bezier_length(truth), 0.02);
}

// A bent spindle of elliptic sections: 0.3 m along a parabola, as a surface of its own triangles.
TriMesh spindle() {
  const int rings = 80, ring = 40;
  TriMesh mesh{Points(rings * ring + 2, 3), Triangles(2 * rings * ring, 3)};
  const auto middle = [](double t) { return Vec3(0.06 * 4 * t * (1 - t), 0.3 * t, 0.02 * t * t); };
  for (int k = 0; k < rings; ++k) {
    const double t = (k + 0.5) / rings;
    const Vec3 along = (middle(t + 1e-4) - middle(t - 1e-4)).normalized(),
               u = along.cross(Vec3::UnitX()).normalized(), v = along.cross(u);
    const double r = 0.025 * std::pow(std::sin(std::numbers::pi * t), 0.8);
    for (int j = 0; j < ring; ++j) {
      const double angle = 2 * std::numbers::pi * j / ring;
      mesh.V.row(k * ring + j) =
          (middle(t) + r * (1.4 * std::cos(angle) * u + 0.7 * std::sin(angle) * v)).transpose();
    }
  }
  mesh.V.row(rings * ring) = middle(0).transpose();
  mesh.V.row(rings * ring + 1) = middle(1).transpose();
  Eigen::Index f = 0;
  for (int j = 0; j < ring; ++j) {
    const int n = (j + 1) % ring;
    mesh.F.row(f++) << rings * ring, n, j;
    for (int k = 0; k + 1 < rings; ++k) {
      mesh.F.row(f++) << k * ring + j, k * ring + n, (k + 1) * ring + n;
      mesh.F.row(f++) << k * ring + j, (k + 1) * ring + n, (k + 1) * ring + j;
    }
    mesh.F.row(f++) << rings * ring + 1, (rings - 1) * ring + j, (rings - 1) * ring + n;
  }
  return mesh;
}

TEST(Resample, GivesABentSpindleBack) {
  const TriMesh mesh = spindle();
  const auto n = mesh.V.rows();
  const Resampled result = resample_muscle(mesh, mesh.V.row(n - 2), mesh.V.row(n - 1));
  EXPECT_TRUE(result.report.mesh_closed);
  EXPECT_TRUE(is_closed(result.loft.F));
  EXPECT_GT(mesh_volume(result.loft), 0);
  EXPECT_LT(result.report.mean_distance(), 0.3e-3);
  EXPECT_LT(result.report.loft_to_mesh.max, 2e-3);
  EXPECT_LT(std::abs(result.report.volume_error()), 0.02);
  EXPECT_EQ(result.report.empty_slices, 0);
}

TEST(Resample, MovesWithTheMesh) {
  TriMesh mesh = spindle();
  const auto n = mesh.V.rows();
  const Resampled still = resample_muscle(mesh, mesh.V.row(n - 2), mesh.V.row(n - 1));
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  mesh.V = (mesh.V * turn.transpose()).rowwise() + Eigen::RowVector3d(1, -2, 0.5);
  const Resampled moved = resample_muscle(mesh, mesh.V.row(n - 2), mesh.V.row(n - 1));
  EXPECT_NEAR(moved.report.loft_volume / still.report.loft_volume, 1, 0.002);
  for (std::size_t k = 0; k < still.slices.size(); ++k) {
    EXPECT_LT((moved.slices[k].center - (turn * still.slices[k].center + Vec3(1, -2, 0.5))).norm(),
              0.5e-3);
  }
}

TEST(Resample, FindsTheEndsByItself) {
  const TriMesh mesh = spindle();
  const auto [a, b] = furthest_ends(mesh);
  const auto n = mesh.V.rows();
  const Vec3 low = mesh.V.row(n - 2), high = mesh.V.row(n - 1);
  EXPECT_LT((a - high).norm(), 0.01);
  EXPECT_LT((b - low).norm(), 0.01);
}

// A closed prism along y over a polygon given in x and z, counter-clockwise seen from +y.
TriMesh prism(const std::vector<Vec2>& outline, double length, double lean) {
  const int n = int(outline.size()), rings = 20;
  TriMesh mesh{Points(n * rings + 2, 3), Triangles(2 * n * rings, 3)};
  Vec2 middle = Vec2::Zero();
  for (const Vec2& p : outline) middle += p / n;
  for (int k = 0; k < rings; ++k)
    for (int i = 0; i < n; ++i) {
      const Vec2 p = outline[i];
      mesh.V.row(k * n + i) << p.x(), length * k / (rings - 1) + lean * p.x(), -p.y();
    }
  mesh.V.row(n * rings) << middle.x(), lean * middle.x(), -middle.y();
  mesh.V.row(n * rings + 1) << middle.x(), length + lean * middle.x(), -middle.y();
  Eigen::Index f = 0;
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n;
    mesh.F.row(f++) << n * rings, next, i;
    for (int k = 0; k + 1 < rings; ++k) {
      mesh.F.row(f++) << k * n + i, k * n + next, (k + 1) * n + next;
      mesh.F.row(f++) << k * n + i, (k + 1) * n + next, (k + 1) * n + i;
    }
    mesh.F.row(f++) << n * rings + 1, n * (rings - 1) + i, n * (rings - 1) + next;
  }
  return mesh;
}

TEST(Resample, CrescentsWithSlantingEndsKeepShapeAndVolume) {
  std::vector<Vec2> crescent;  // a ring's third, 30 mm outside and 15 mm thick
  for (int k = 0; k <= 16; ++k)
    crescent.push_back(0.030 * Vec2(std::cos(2.1 * k / 16), std::sin(2.1 * k / 16)));
  for (int k = 16; k >= 0; --k)
    crescent.push_back(0.015 * Vec2(std::cos(2.1 * k / 16), std::sin(2.1 * k / 16)));
  const TriMesh mesh = prism(crescent, 0.2, 0.8);
  ASSERT_GT(mesh_volume(mesh), 0);
  const Resampled result = resample_muscle(mesh);
  EXPECT_LT(result.report.mean_distance(), 0.6e-3);
  EXPECT_LT(std::abs(result.report.volume_error()), 0.005);
  EXPECT_LT(result.report.forked, 1e-3);
}

TEST(Resample, TellsAForkFromABend) {
  const std::vector<Vec2> square{{0, 0}, {0.02, 0}, {0.02, 0.02}, {0, 0.02}};
  TriMesh fork = prism(square, 0.2, 0);
  const TriMesh arm = fork;
  fork.V.conservativeResize(2 * arm.V.rows(), 3);
  fork.V.bottomRows(arm.V.rows()) = arm.V.rowwise() + Eigen::RowVector3d(0.03, 0, 0);
  fork.F.conservativeResize(2 * arm.F.rows(), 3);
  fork.F.bottomRows(arm.F.rows()) = arm.F.array() + int(arm.V.rows());
  EXPECT_NEAR(resample_muscle(fork, Vec3(0.01, 0, -0.01), Vec3(0.01, 0.2, -0.01)).report.forked,
              0.5, 0.05);
  EXPECT_EQ(resample_muscle(arm, Vec3(0.01, 0, -0.01), Vec3(0.01, 0.2, -0.01)).report.forked, 0);
}

TEST(Resample, StripsKeepTheEllipses) {
  const TriMesh mesh = spindle();
  const auto n = mesh.V.rows();
  const Resampled result = resample_muscle(mesh, mesh.V.row(n - 2), mesh.V.row(n - 1));
  const Strip strip = make_strip(result, 0, 1);
  const auto ellipses = rest_slices(strip);
  ASSERT_EQ(ellipses.size(), result.slices.size());
  for (std::size_t k = 0; k < ellipses.size(); ++k) {
    EXPECT_LT((ellipses[k].center - result.slices[k].center).norm(), 2e-3);
    EXPECT_LT((ellipses[k].radii - result.slices[k].radii).norm(), 1e-9);
    EXPECT_EQ(ellipses[k].outline, result.slices[k].outline);
  }
}

TEST(Resample, RefusesWhatCannotBe) {
  const TriMesh mesh = spindle();
  const auto n = mesh.V.rows();
  const Vec3 a = mesh.V.row(n - 2), b = mesh.V.row(n - 1);
  EXPECT_THROW(resample_muscle(mesh, a, a), UnfitError);
  EXPECT_THROW(resample_muscle(mesh, 1000 * a + Vec3(0, 9, 0), b), UnfitError);
  EXPECT_THROW(resample_muscle({mesh.V, Triangles::Zero(3, 3)}, a, b), UnfitError);
  ResampleOptions options;
  options.slices = 1;
  EXPECT_THROW(resample_muscle(mesh, a, b, options), std::invalid_argument);
}

// Muscles modelled from a real body; fusiform ones of one shell. Their meshes are open by a few
// slits.
TEST(Resample, RealMusclesWithinAMillimetreAndAHalf) {
  const fs::path archive =
      fs::path(ECORCHE_SHARED_DIR) / "testdata/anatomy/bodyparts3d_glb/bodyparts3d_glb.tar.xz";
  if (!fs::exists(archive)) GTEST_SKIP() << archive << " is not there";
  const fs::path folder =
      fs::temp_directory_path() / ("ecorche_resample_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string command = "tar -xf '" + archive.string() + "' -C '" + folder.string() +
                              "' --wildcards '*Long_head_of_left_biceps_brachii.glb' "
                              "'*Left_flexor_carpi_radialis.glb' '*Right_gracilis.glb' "
                              "'*Right_teres_major.glb' '*Left_psoas_major.glb'";
  if (std::system(command.c_str()) != 0) GTEST_SKIP() << "tar cannot unpack the archive";
  int muscles = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".glb") continue;
    TriMesh mesh = read_mesh(entry.path());
    if ((mesh.V.colwise().maxCoeff() - mesh.V.colwise().minCoeff()).norm() > 2) mesh.V *= 1e-3;
    const Resampled result = resample_muscle(mesh);
    EXPECT_LT(result.report.mean_distance(), 1e-3) << entry.path();
    EXPECT_LT(std::abs(result.report.volume_error()), 0.06) << entry.path();
    ++muscles;
  }
  fs::remove_all(folder);
  EXPECT_EQ(muscles, 5);
}

}  // namespace
}  // namespace ecorche
