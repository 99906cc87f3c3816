// Laws of filled outlines: areas, holes, gaps, crossings.
#include "anatomy/geometry/fill_outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ecorche {
namespace {

struct Outline {
  std::vector<Vec2> points;
  std::vector<std::array<int, 2>> segments;

  void add_circle(const Vec2& center, double radius, int count, bool turned = false) {
    const int first = int(points.size());
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count * (turned ? -1 : 1);
      points.emplace_back(center + radius * Vec2(std::cos(angle), std::sin(angle)));
      segments.push_back({first + i, first + (i + 1) % count});
    }
  }
};

double area_of(const FilledOutline& filled) {
  double area = 0;
  for (const auto& t : filled.triangles) {
    const Vec2 a = filled.points[std::size_t(t[0])], b = filled.points[std::size_t(t[1])] - a,
               c = filled.points[std::size_t(t[2])] - a;
    const double own = 0.5 * (b.x() * c.y() - b.y() * c.x());
    EXPECT_GE(own, 0) << "counter-clockwise";
    area += own;
  }
  return area;
}

double circle_area(double radius, int count) {
  return 0.5 * count * radius * radius * std::sin(2 * std::numbers::pi / count);
}

TEST(FillOutline, LoopsAreFilledAndLoopsWithinThemThatTurnBackAreHoles) {
  Outline ring;
  ring.add_circle({0.3, -0.1}, 0.10, 40);
  EXPECT_NEAR(area_of(fill_outline(ring.points, ring.segments)), circle_area(0.10, 40), 1e-12);
  ring.add_circle({0.31, -0.1}, 0.05, 30, true);
  EXPECT_NEAR(area_of(fill_outline(ring.points, ring.segments)),
              circle_area(0.10, 40) - circle_area(0.05, 30), 1e-12);
  ring.add_circle({0.31, -0.1}, 0.02, 20);  // an island in the hole
  ring.add_circle({0.60, 0.2}, 0.03, 20);
  EXPECT_NEAR(
      area_of(fill_outline(ring.points, ring.segments)),
      circle_area(0.10, 40) - circle_area(0.05, 30) + circle_area(0.02, 20) + circle_area(0.03, 20),
      1e-12);
}

TEST(FillOutline, ALoopThatTurnsTheOtherWayIsFilledToo) {
  Outline disc;
  disc.add_circle({0, 0}, 0.1, 40, true);
  EXPECT_NEAR(area_of(fill_outline(disc.points, disc.segments)), circle_area(0.1, 40), 1e-12);
}

TEST(FillOutline, OverlapsCountOnceAndCrossingsBecomePoints) {
  Outline pair;
  pair.points = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1}, {3, 1}, {3, 3}, {1, 3}};
  for (int k = 0; k < 4; ++k)
    for (const int first : {0, 4}) pair.segments.push_back({first + k, first + (k + 1) % 4});
  const FilledOutline filled = fill_outline(pair.points, pair.segments);
  EXPECT_NEAR(area_of(filled), 7, 1e-12);
  EXPECT_EQ(filled.points.size(), 10u);
  EXPECT_EQ(filled.points[5], Vec2(3, 1)) << "given points keep their numbers";
}

TEST(FillOutline, GapsAreClosedByTheShortestWay) {
  Outline open;
  open.add_circle({0, 0}, 0.1, 40);
  open.add_circle({0.5, 0}, 0.1, 40);
  open.segments.erase(open.segments.begin() + 50);
  open.segments.erase(open.segments.begin() + 10);
  EXPECT_NEAR(area_of(fill_outline(open.points, open.segments)), 2 * circle_area(0.1, 40), 1e-12);
}

TEST(FillOutline, WhatGoesAroundNothingIsEmpty) {
  EXPECT_TRUE(fill_outline({}, {}).triangles.empty());
  Outline line;
  line.points = {{0, 0}, {1, 0}};
  line.segments = {{0, 1}, {1, 0}};
  EXPECT_TRUE(fill_outline(line.points, line.segments).triangles.empty());
}

}  // namespace
}  // namespace ecorche
