#include "anatomy/base_mesh/body_package.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/errors.h"
#include "tests/body_fixture.h"

namespace ecorche {
namespace {

std::map<std::pair<int, int>, int> directed_edges(const Triangles& F) {
  std::map<std::pair<int, int>, int> edges;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) ++edges[{F(f, k), F(f, (k + 1) % 3)}];
  }
  return edges;
}

bool is_closed(const Triangles& F) {
  const auto edges = directed_edges(F);
  for (const auto& [edge, count] : edges) {
    if (count != 1 || !edges.contains({edge.second, edge.first})) return false;
  }
  return true;
}

double volume_of(const TriMesh& mesh) {
  double six = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    six += a.dot(b.cross(c));
  }
  return six / 6;
}

class BodyPackageTest : public BodyFixture {};

TEST_F(BodyPackageTest, SkinAndCappedSkinAreClosed) {
  const TriMesh skin = skin_mesh(package(), package().points);
  EXPECT_EQ(skin.V.rows(), 13380);
  EXPECT_EQ(skin.F.rows(), 26756);
  EXPECT_TRUE(is_closed(skin.F));
  const TriMesh capped = capped_skin(package(), package().points);
  EXPECT_TRUE(is_closed(capped.F));
  EXPECT_EQ(capped.F.rows(), 26756 - 1968 + 28 + 38 + 28);
  EXPECT_GT(volume_of(capped), volume_of(skin));  // mouth and sockets are filled
}

TEST_F(BodyPackageTest, MirrorMapsSkinOntoItself) {
  const auto& p = package();
  double worst = 0;
  for (Eigen::Index i = 0; i < p.skin_size; ++i) {
    const Vec3 here = p.points.row(i), there = p.points.row(p.mirror[i]);
    worst = std::max(worst, (here - Vec3(-there.x(), there.y(), there.z())).norm());
  }
  EXPECT_LT(worst, 1e-3);
  const auto edges = directed_edges(p.triangles);
  int unlike = 0;
  for (const auto& [edge, count] : edges) {
    if (!edges.contains({p.mirror[edge.second], p.mirror[edge.first]})) ++unlike;
  }
  EXPECT_EQ(unlike, 0);
}

TEST_F(BodyPackageTest, RigsAreTreesWithWeightsThatSumToOne) {
  const std::map<std::string, std::size_t> sizes{
      {"default", 163}, {"cmu_mb", 31}, {"mixamo", 52}, {"game_engine", 53}};
  for (const auto& [name, size] : sizes) {
    const Rig rig = read_rig(package(), name, package().points);
    ASSERT_EQ(rig.names.size(), size) << name;
    for (std::size_t b = 0; b < size; ++b) {
      EXPECT_LT(rig.parents[b], int(b));
      EXPECT_TRUE(rig.axes[b].isUnitary(1e-9));
      EXPECT_LT((rig.axes[b].col(1) - (rig.tails[b] - rig.heads[b]).normalized()).norm(), 1e-9)
          << rig.names[b];
    }
    ASSERT_EQ(rig.weights.start.size(), std::size_t(package().skin_size) + 1);
    for (std::size_t i = 0; i + 1 < rig.weights.start.size(); ++i) {
      double sum = 0;
      for (int k = rig.weights.start[i]; k < rig.weights.start[i + 1]; ++k)
        sum += rig.weights.weight[k];
      EXPECT_NEAR(sum, 1, 1e-12);
    }
  }
  EXPECT_THROW(read_rig(package(), "nobody", package().points), UnfitError);
}

TEST_F(BodyPackageTest, PartsMirrorAndCoverTheBody) {
  const auto parts = vertex_parts(package());
  std::map<BodyPart, int> counts;
  int unlike = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    ++counts[parts[i].part];
    const auto& other = parts[package().mirror[i]];
    unlike += other.part != parts[i].part ||
              (parts[i].side != Side::middle && other.side == parts[i].side);
  }
  EXPECT_EQ(counts.size(), 9u);
  EXPECT_LT(unlike, 20);  // vertices whose two parts weigh the same
}

TEST(BodyPackageErrors, NamesTheMissingFile) {
  try {
    read_body_package([](const std::string&) { return std::nullopt; }, {});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("base.obj"), std::string::npos);
  }
}

TEST(BodyPackageErrors, NamesTheLineOfABadMesh) {
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 1 x 0\n";
  try {
    read_body_package([&](const std::string&) { return mesh; }, {});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("base.obj:3"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace ecorche
