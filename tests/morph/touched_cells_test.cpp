// Lines through a grid of marked boxes, against the distance between line and box.
#include "anatomy/queries/occupancy_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ecorche {
namespace {

constexpr double kSize = 0.01;

// The line's least distance from the box, by steps much finer than a cell.
double distance(const Eigen::AlignedBox3d& box, const Vec3& from, const Vec3& direction,
                double length) {
  double least = 1e300;
  for (int k = 0; k <= 4000; ++k)
    least = std::min(least, box.exteriorDistance(from + length * k / 4000 * direction));
  return least;
}

TEST(TouchedCells, NeverMissWhatWasMarkedAndSeldomTellOfMore) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 0.3), way(-1, 1), small(0, 0.03);
  TouchedCells cells(Eigen::AlignedBox3d(Vec3(0, 0, 0), Vec3(0.3, 0.3, 0.3)), kSize);
  int through = 0, said = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 low(place(random), place(random), place(random));
    const Eigen::AlignedBox3d box(
        low, (low + Vec3(small(random), small(random), small(random))).cwiseMin(0.3));
    cells.clear();
    cells.mark(box);
    const Vec3 from = low + 0.08 * Vec3(way(random), way(random), way(random)),
               direction =
                   (low - from + 0.05 * Vec3(way(random), way(random), way(random))).normalized();
    const double away = distance(box, from, direction, 0.12);
    const bool touches = cells.touches(from, direction, 0.12);
    EXPECT_TRUE(touches || away > 0) << n;
    EXPECT_FALSE(touches && away > 1.5 * std::sqrt(3.0) * kSize) << n;
    through += away == 0;
    said += touches;
  }
  EXPECT_GT(through, 40);
  EXPECT_GT(said, through);
}

TEST(TouchedCells, ForgetWhatLiesBeyond) {
  TouchedCells cells(Eigen::AlignedBox3d(Vec3(0, 0, 0), Vec3(0.1, 0.1, 0.1)), kSize);
  cells.mark(Eigen::AlignedBox3d(Vec3(-1, -1, -1), Vec3(-0.5, -0.5, -0.5)));
  cells.mark(Eigen::AlignedBox3d(Vec3(0.05, 0.3, 0.05), Vec3(0.06, 0.4, 0.06)));
  EXPECT_FALSE(cells.touches(Vec3(0.055, 0, 0.055), Vec3::UnitY(), 1));
  EXPECT_FALSE(cells.touches(Vec3(5, 5, 5), Vec3::UnitX(), 1));
}

}  // namespace
}  // namespace ecorche
