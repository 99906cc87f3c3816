// Laws of slits: none where muscles touch or lie far apart, the area of the gap where they part by
// some millimetres, and none where the gap has a floor.
#include "skinning/checks/slits.h"

#include <gtest/gtest.h>

#include <numeric>

#include "anatomy/geometry/join_meshes.h"

namespace ecorche {
namespace {

// Closed, faces outwards.
TriMesh box(const Vec3& low, const Vec3& high) {
  TriMesh out{Points(8, 3), Triangles(12, 3)};
  for (int i = 0; i < 8; ++i)
    out.V.row(i) << (i & 1 ? high : low).x(), (i & 2 ? high : low).y(), (i & 4 ? high : low).z();
  out.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6,
      1, 3, 5, 3, 7, 5;
  return out;
}

// Two slabs of 60 x 200 x 30 mm side by side, a skin 5 mm above them, of which its upper side is
// looked at. `floor`: a third one's depth below their upper side.
double slits_between(double gap, double floor = 0) {
  std::vector<TriMesh> slabs{box({-0.06 - gap / 2, 0, -0.03}, {-gap / 2, 0.2, 0}),
                             box({gap / 2, 0, -0.03}, {0.06 + gap / 2, 0.2, 0})};
  if (floor > 0) slabs.push_back(box({-0.05, 0, -0.025}, {0.05, 0.2, -floor}));
  std::vector<const TriMesh*> all;
  for (const TriMesh& slab : slabs) all.push_back(&slab);
  TriMesh skin{Points(4, 3), Triangles(2, 3)};
  skin.V << -0.05, 0.02, 0.005, 0.05, 0.02, 0.005, -0.05, 0.18, 0.005, 0.05, 0.18, 0.005;
  skin.F << 0, 1, 2, 1, 3, 2;
  const std::vector<double> areas =
      slit_areas(skin, std::vector<float>(4, 0.0045f), std::vector<char>(4, 1), join_meshes(all));
  return std::accumulate(areas.begin(), areas.end(), 0.0);
}

TEST(Slits, AreTheAreaOfAGap) {
  EXPECT_EQ(slits_between(0), 0);
  EXPECT_NEAR(slits_between(0.006), 0.16 * 0.006, 0.16 * 0.001);
  EXPECT_NEAR(slits_between(0.012), 0.16 * 0.012, 0.16 * 0.001);
}

TEST(Slits, AreNoneWhereTheGapHasAFloor) {
  EXPECT_EQ(slits_between(0.006, 0.008), 0);
  EXPECT_GT(slits_between(0.006, 0.015), 0.0005);
}

TEST(Slits, EndWhereNothingIsBesideThem) {
  EXPECT_NEAR(slits_between(0.04), 0.16 * 0.016, 0.16 * 0.002);  // 8 mm on either side
}

}  // namespace
}  // namespace ecorche
