// Laws of halved edges: none is left too long, the mesh stays closed, vertices stay, a plane stays
// plane, and a texture's places follow.
#include "anatomy/geometry/split_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "anatomy/geometry/mesh_measures.h"
#include "ball.h"

namespace ecorche {
namespace {

Refinement no_refinement(const TriMesh& mesh) { return refine(mesh.F, int(mesh.V.rows()), 0); }

TEST(SplitEdges, LeavesNoEdgeTooLongAndTheMeshClosed) {
  const TriMesh mesh = test::ball(2);
  Points V = mesh.V;
  std::vector<TextureCorner> none;
  const auto longest = [](const Vec3& p) { return p.y() > 0 ? 0.12 : 1.0; };
  const Refinement finer = split_long_edges(no_refinement(mesh), V, longest, none, 6);
  EXPECT_GT(V.rows(), 2 * mesh.V.rows());
  EXPECT_TRUE(V.topRows(mesh.V.rows()) == mesh.V);
  EXPECT_LT((refine_points(finer, mesh.V) - V).cwiseAbs().maxCoeff(), 1e-12);
  std::map<std::pair<int, int>, int> edges;
  for (Eigen::Index f = 0; f < finer.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = finer.F(f, k), b = finer.F(f, (k + 1) % 3);
      ++edges[{a, b}];
      if (V(a, 1) > 0.2 && V(b, 1) > 0.2) EXPECT_LE((V.row(a) - V.row(b)).norm(), 0.12);
    }
  for (const auto& [edge, times] : edges) {
    EXPECT_EQ(times, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  const double volume = mesh_volume({V, finer.F});
  EXPECT_GT(volume, mesh_volume(mesh));
  EXPECT_LT(volume, 1.01 * 4.1887902);
}

TEST(SplitEdges, APlaneStaysPlaneAndPlacesOnItFollow) {
  TriMesh mesh{Points(4, 3), Triangles(2, 3)};
  mesh.V << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  mesh.F << 0, 1, 2, 0, 2, 3;
  std::vector<TextureCorner> corners;
  for (Eigen::Index f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k)
      corners.emplace_back(mesh.V.row(mesh.F(f, k)).head<2>().cast<float>());
  Points V = mesh.V;
  const auto longest = [](const Vec3& p) { return 0.1 + 0.2 * p.x(); };
  const Refinement finer = split_long_edges(no_refinement(mesh), V, longest, corners, 5);
  ASSERT_EQ(Eigen::Index(corners.size()), 3 * finer.F.rows());
  double area = 0;
  for (Eigen::Index f = 0; f < finer.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = V.row(finer.F(f, k));
      const TextureCorner& place = corners[std::size_t(3 * f + k)];
      EXPECT_NEAR(p.z(), 0, 1e-12);
      // butterfly middles leave the straight line between their ends only beside boundaries
      EXPECT_NEAR(p.x(), place[0], 0.1);
      EXPECT_NEAR(p.y(), place[1], 0.1);
    }
    const TextureCorner *c = &corners[std::size_t(3 * f)], a = c[1] - c[0], b = c[2] - c[0];
    EXPECT_GT(a[0] * b[1] - a[1] * b[0], 0);
    area += 0.5 * double(a[0] * b[1] - a[1] * b[0]);
  }
  EXPECT_NEAR(area, 1, 1e-6);
}

}  // namespace
}  // namespace ecorche
