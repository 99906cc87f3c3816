// Which flipped triangles lie in contact folds: on shapes whose answer is known beforehand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "skinning/evaluation/contact_folds.h"

namespace ecorche {
namespace {

constexpr int kCells = 8;
constexpr double kCell = 0.01;

// Two square sheets of kCells x kCells cells side by side, 0.3 m apart, both facing up.
TriMesh two_sheets() {
  constexpr int kRow = kCells + 1, kOne = kRow * kRow;
  TriMesh out{Points(2 * kOne, 3), Triangles(4 * kCells * kCells, 3)};
  Eigen::Index f = 0;
  for (int sheet = 0; sheet < 2; ++sheet) {
    for (int j = 0; j < kRow; ++j)
      for (int i = 0; i < kRow; ++i)
        out.V.row(sheet * kOne + j * kRow + i) << i * kCell + 0.3 * sheet, 0, -j * kCell;
    for (int j = 0; j < kCells; ++j)
      for (int i = 0; i < kCells; ++i) {
        const int a = sheet * kOne + j * kRow + i;
        out.F.row(f++) << a, a + 1, a + kRow + 1;
        out.F.row(f++) << a, a + kRow + 1, a + kRow;
      }
  }
  return out;
}

// The second sheet turned over and laid over the first, `height` above it.
Points folded(const TriMesh& rest, double height) {
  Points V = rest.V;
  for (Eigen::Index i = V.rows() / 2; i < V.rows(); ++i)
    V.row(i) << kCells * kCell - (rest.V(i, 0) - 0.3), height, rest.V(i, 2);
  return V;
}

int count(const TriMesh& rest, const Points& V) {
  std::vector<int> first(rest.F.rows() / 2);
  std::iota(first.begin(), first.end(), 0);
  const std::vector<char> in = in_contact_folds(rest, V, first);
  return int(std::count(in.begin(), in.end(), 1));
}

TEST(ContactFolds, AreWhereOtherSkinLiesInFrontWithinReach) {
  const TriMesh rest = two_sheets();
  const int all = rest.F.rows() / 2;
  EXPECT_EQ(count(rest, rest.V), 0);
  EXPECT_EQ(count(rest, folded(rest, 0.004)), all);
  EXPECT_EQ(count(rest, folded(rest, 0.006)), 0);
  EXPECT_EQ(count(rest, folded(rest, -0.0005)), all);  // a little way through
  EXPECT_EQ(count(rest, folded(rest, -0.003)),
            0);  // they lie behind each other, as sides of what has collapsed
}

TEST(ContactFolds, ReachAsFarAsTheOtherSkin) {
  const TriMesh rest = two_sheets();
  Points V = folded(rest, 0.003);
  for (Eigen::Index i = V.rows() / 2; i < V.rows(); ++i)
    V(i, 0) += 4 * kCell;  // over the right half alone, and 4 mm more
  int wanted = 0;
  for (Eigen::Index f = 0; f < rest.F.rows() / 2; ++f) {
    const double x =
        (rest.V(rest.F(f, 0), 0) + rest.V(rest.F(f, 1), 0) + rest.V(rest.F(f, 2), 0)) / 3;
    wanted += std::hypot(std::max(0.0, 4 * kCell - x), 0.003) <= 0.005;
  }
  EXPECT_EQ(count(rest, V), wanted);
  EXPECT_LT(wanted, int(rest.F.rows() / 2));
}

TEST(ContactFolds, NeedSkinOfAnotherPlace) {
  TriMesh rest = two_sheets();
  const Points V = folded(rest, 0.004);
  rest.V = folded(rest, 0.015);  // as near as that at rest already
  EXPECT_EQ(count(rest, V), 0);
  rest.V = folded(two_sheets(), 0.025);
  EXPECT_GT(count(rest, V), 0);
}

TEST(ContactFolds, TakeAFlippedTriangleForPartOfTheSkinAboutIt) {
  const TriMesh rest = two_sheets();
  Points V = folded(rest, 0.004);
  const int corner = 4 * (kCells + 1) +
                     4;  // drawn over the far sides of its triangles: some of them are turned over
  V.row(corner) += Eigen::RowVector3d(1.4 * kCell, 0, -1.4 * kCell);
  std::vector<int> turned;
  for (Eigen::Index f = 0; f < rest.F.rows() / 2; ++f) {
    const Vec3 a = V.row(rest.F(f, 0)), b = V.row(rest.F(f, 1)), c = V.row(rest.F(f, 2));
    if ((b - a).cross(c - a).y() < -1e-8) turned.push_back(int(f));
  }
  ASSERT_GT(turned.size(), 0u);
  EXPECT_EQ(in_contact_folds(rest, V, turned), std::vector<char>(turned.size(), 1));
  for (Eigen::Index i = V.rows() / 2; i < V.rows(); ++i) V(i, 1) = -0.003;
  EXPECT_EQ(in_contact_folds(rest, V, turned), std::vector<char>(turned.size(), 0));
}

}  // namespace
}  // namespace ecorche
