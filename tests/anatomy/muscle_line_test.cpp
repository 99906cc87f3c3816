// Laws of the rest line: it meets its path points, sections survive the way to slices and back,
// carrying is a map of bodies.
#include "anatomy/muscles/action_line.h"

#include <gtest/gtest.h>

#include <numbers>

#include "anatomy/muscles/transform_muscles.h"
#include "tests/anatomy/strips.h"

using namespace ecorche;
using namespace ecorche::testing;

namespace {

Strip bent_strip() {
  std::vector<Station> stations = spindle(15, 0.02, 0.004, 0.2, 0.8, Vec3::UnitX());
  for (Station& s : stations) {
    s.width = Vec3(std::cos(s.s), 0.2, std::sin(s.s));
    s.offset = Vec3(0.002, 0, 0.003 * s.s);
  }
  return make_strip(bent_path(), stations);
}

double distance(const Ellipse& a, const Ellipse& b) {
  return (a.center - b.center).norm() + (a.axes - b.axes).norm() + (a.radii - b.radii).norm();
}

}  // namespace

TEST(MuscleLine, MeetsItsPathPointsAndIsMeasuredByItsLength) {
  const auto path = bent_path();
  const auto s = path_parameters(path);
  const auto points = line_points(path, s);
  for (size_t i = 0; i < path.size(); ++i) EXPECT_LT((points[i] - path[i].rest).norm(), 1e-6);
  std::vector<double> even;
  for (int k = 0; k <= 400; ++k) even.push_back(k / 400.0);
  const auto line = line_points(path, even);
  for (int k = 0; k < 400; ++k)
    EXPECT_NEAR((line[k + 1] - line[k]).norm(), line_length(path) / 400,
                0.01 * line_length(path) / 400);
}

TEST(MuscleLine, WeightsSumToOneSoThatTheLineMovesWithItsPoints) {
  const auto path = bent_path();
  for (const LineNode& node : line_nodes(path, std::vector<double>{0, 0.1, 0.33, 0.77, 1}))
    EXPECT_NEAR(node.weight[0] + node.weight[1] + node.weight[2] + node.weight[3], 1, 1e-12);
}

TEST(MuscleLine, StraightPathsStayStraightHoweverUneven) {
  const std::vector<PathPoint> path{on(0, {0, 0, 0}), on(0, {0, 0.01, 0}), on(0, {0, 0.3, 0}),
                                    on(0, {0, 0.31, 0})};
  for (const Vec3& p : line_points(path, std::vector<double>{0.01, 0.2, 0.5, 0.99}))
    EXPECT_LT(std::hypot(p.x(), p.z()), 1e-15);
  EXPECT_NEAR(line_length(path), 0.31, 1e-12);
}

TEST(MuscleLine, SectionsComeBackAsTheyWereGiven) {
  std::vector<Station> stations = spindle(15, 0.02, 0.004, 0.2, 0.8, Vec3(1, 0.1, 0.3));
  const Strip strip = make_strip(bent_path(), stations);
  const auto ellipses = rest_slices(strip);
  for (size_t k = 0; k < ellipses.size(); ++k) {
    EXPECT_EQ(ellipses[k].radii, stations[k].radii);
    // The width lies in the plane of the wished direction and the line.
    const Vec3 normal = ellipses[k].axes.col(2).cross(stations[k].width).normalized();
    EXPECT_LT(std::abs(ellipses[k].axes.col(0).dot(normal)), 1e-12);
    EXPECT_TRUE((ellipses[k].axes.transpose() * ellipses[k].axes).isIdentity(1e-12));
    EXPECT_NEAR(ellipses[k].axes.determinant(), 1, 1e-12);
  }
}

TEST(MuscleLine, EllipsesGoBackIntoSlices) {
  Strip strip = bent_strip();
  const auto before = rest_slices(strip);
  set_slices(strip, before);
  const auto after = rest_slices(strip);
  for (size_t k = 0; k < before.size(); ++k) EXPECT_LT(distance(before[k], after[k]), 1e-12);
}

TEST(MuscleLine, ResampledStationsAgreeAtTheirOwnPlaces) {
  const auto path = bent_path();
  const auto stations = spindle(9, 0.02, 0.004, 0.2, 0.8, Vec3(1, 0.1, 0.3));
  std::vector<double> s;
  for (const auto& station : stations) s.push_back(station.s);
  const auto again = resample_stations(path, stations, s);
  for (size_t k = 0; k < s.size(); ++k) {
    EXPECT_LT((again[k].radii - stations[k].radii).norm(), 1e-15);
    EXPECT_LT((again[k].offset - stations[k].offset).norm(), 1e-15);
  }
}

TEST(MuscleLine, TubeVolumeIsExactForConesAndBends) {
  std::vector<Ellipse> cone(2);
  cone[0].axes.col(0) = Vec3::UnitX();
  cone[0].axes.col(1) = Vec3::UnitY();
  cone[0].axes.col(2) = Vec3::UnitZ();
  cone[1] = cone[0];
  cone[1].center = Vec3(0.01, 0, 0.1);
  cone[0].radii = Vec2(0.02, 0.01);
  cone[1].radii = Vec2(0.04, 0.02);
  EXPECT_NEAR(tube_volume(cone), std::numbers::pi * 0.1 / 3 * (0.0002 + 0.0004 + 0.0008), 1e-15);
  // A quarter of a torus: Pappus.
  std::vector<Ellipse> torus;
  for (int k = 0; k <= 400; ++k) {
    const double a = std::numbers::pi / 2 * k / 400;
    Ellipse e;
    e.center = 0.1 * Vec3(std::cos(a), std::sin(a), 0);
    e.axes.col(2) = Vec3(-std::sin(a), std::cos(a), 0);
    e.axes.col(0) = Vec3(std::cos(a), std::sin(a), 0);
    e.axes.col(1) = e.axes.col(2).cross(e.axes.col(0));
    e.radii = Vec2(0.03, 0.02);
    torus.push_back(e);
  }
  EXPECT_NEAR(tube_volume(torus) / (std::numbers::pi * 0.03 * 0.02 * 0.1 * std::numbers::pi / 2), 1,
              1e-5);
}

TEST(CarryMuscles, TheSameBodyGivesTheSameStrip) {
  const Strip strip = bent_strip();
  const Strip same = carry_strip(strip, [](const Vec3& p, int) { return p; });
  const auto a = rest_slices(strip), b = rest_slices(same);
  for (size_t k = 0; k < a.size(); ++k) EXPECT_LT(distance(a[k], b[k]), 1e-9);
}

TEST(CarryMuscles, RigidMotionCarriesEverySlice) {
  Transform X = Transform::Identity();
  X.linear() = Quat(Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized())).toRotationMatrix();
  X.translation() = Vec3(0.1, -0.4, 0.2);
  Strip strip = bent_strip();
  Wrap wrap;
  wrap.kind = Wrap::Kind::cylinder;
  wrap.X_WO.translation() = Vec3(0.05, 1, 0);
  wrap.radii = Vec3(0.01, 0.01, 0.05);
  strip.wraps.push_back(wrap);
  const Strip moved = carry_strip(strip, [&](const Vec3& p, int) { return X * p; });
  const auto a = rest_slices(strip), b = rest_slices(moved);
  for (size_t k = 0; k < a.size(); ++k) {
    EXPECT_LT((X * a[k].center - b[k].center).norm(), 1e-9);
    EXPECT_LT((X.linear() * a[k].axes - b[k].axes).norm(), 1e-9);
  }
  EXPECT_TRUE(moved.wraps[0].X_WO.isApprox(X * wrap.X_WO, 1e-9));
  EXPECT_LT((moved.wraps[0].radii - wrap.radii).norm(), 1e-12);
}

TEST(CarryMuscles, AMirrorGivesTheMirrorImage) {
  const Strip strip = bent_strip();
  const Eigen::DiagonalMatrix<double, 3> M(-1, 1, 1);
  const Strip moved = carry_strip(strip, [&](const Vec3& p, int) -> Vec3 { return M * p; });
  const auto a = rest_slices(strip), b = rest_slices(moved);
  for (size_t k = 0; k < a.size(); ++k) {
    EXPECT_LT((M * a[k].center - b[k].center).norm(), 1e-9);
    EXPECT_LT((M * a[k].axes.col(2) - b[k].axes.col(2)).norm(), 1e-9);
    EXPECT_NEAR(std::abs((M * a[k].axes.col(0)).dot(b[k].axes.col(0))), 1, 1e-9);
  }
}

TEST(CarryMuscles, ScaleLaw) {
  const Strip strip = bent_strip();
  Strip moved = carry_strip(strip, [&](const Vec3& p, int) -> Vec3 { return 1.3 * p; });
  EXPECT_NEAR(moved.rest_length, 1.3 * strip.rest_length, 1e-9);
  for (size_t k = 0; k < strip.slices.size(); ++k) {
    EXPECT_NEAR(moved.slices[k].roll, strip.slices[k].roll, 1e-9);
    EXPECT_LT((moved.slices[k].offset - 1.3 * strip.slices[k].offset).norm(), 1e-9);
  }
  Muscle before, after;
  before.strips.push_back(strip);
  for (Slice& slice : moved.slices) slice.radii *= 1.3;
  after.strips.push_back(moved);
  EXPECT_NEAR(rest_volume(after) / rest_volume(before), 1.3 * 1.3 * 1.3, 1e-9);
}
