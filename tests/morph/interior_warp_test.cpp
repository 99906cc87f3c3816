#include "morph/tissue/interior_warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "morph/fit/template_tissue.h"

namespace ecorche {
namespace {

// A ball of `rings` x 2 `rings` faces about a place.
TriMesh ball(const Vec3& at, double radius, int rings) {
  const int around = 2 * rings;
  TriMesh mesh{Points(2 + (rings - 1) * around, 3), Triangles(2 * (rings - 1) * around, 3)};
  mesh.V.row(0) = at + radius * Vec3::UnitY();
  mesh.V.row(mesh.V.rows() - 1) = at - radius * Vec3::UnitY();
  const auto vertex = [&](int ring, int k) { return 1 + (ring - 1) * around + k % around; };
  Eigen::Index f = 0;
  for (int ring = 1; ring < rings; ++ring) {
    for (int k = 0; k < around; ++k) {
      const double polar = M_PI * ring / rings, turn = 2 * M_PI * k / around;
      mesh.V.row(vertex(ring, k)) =
          at + radius * Vec3(std::sin(polar) * std::sin(turn), std::cos(polar),
                             std::sin(polar) * std::cos(turn));
      if (ring == 1)
        mesh.F.row(f++) << 0, vertex(1, k), vertex(1, k + 1);
      else {
        mesh.F.row(f++) << vertex(ring - 1, k), vertex(ring, k), vertex(ring, k + 1);
        mesh.F.row(f++) << vertex(ring - 1, k), vertex(ring, k + 1), vertex(ring - 1, k + 1);
      }
      if (ring == rings - 1)
        mesh.F.row(f++) << vertex(ring, k), int(mesh.V.rows()) - 1, vertex(ring, k + 1);
    }
  }
  return mesh;
}

struct Figure {
  TriMesh skin = ball(Vec3(0.02, 1, 0), 0.1, 16);
  std::vector<Bone> bones{{"core", Side::middle, 0, ball(Vec3(0.03, 1.01, 0), 0.03, 10)}};
};

Figure mapped(const Figure& figure, const std::function<Vec3(const Vec3&)>& map) {
  Figure out = figure;
  for (Eigen::Index i = 0; i < out.skin.V.rows(); ++i)
    out.skin.V.row(i) = map(figure.skin.V.row(i));
  for (Eigen::Index i = 0; i < out.bones[0].mesh.V.rows(); ++i)
    out.bones[0].mesh.V.row(i) = map(figure.bones[0].mesh.V.row(i));
  return out;
}

BodyPair pair_of(const Figure& before, const Figure& after) {
  return {&before.skin.V, &after.skin.V, &before.bones, &after.bones};
}

Vec3 sheared(const Vec3& p) {
  Mat3 A;
  A << 1.1, 0.1, 0, -0.05, 0.9, 0.02, 0, 0.03, 1.2;
  return A * p + Vec3(0.3, -0.2, 0.1);
}

// Over points inside the ball of the skin.
double furthest_off(const InteriorMap& map, const std::function<Vec3(const Vec3&)>& truth) {
  double worst = 0;
  for (double x = -0.05; x <= 0.09; x += 0.017)
    for (double y = 0.93; y <= 1.07; y += 0.019)
      for (double z = -0.05; z <= 0.05; z += 0.021)
        if (const Vec3 p(x, y, z); (p - Vec3(0.02, 1, 0)).norm() < 0.095)
          worst = std::max(worst, (map(p) - truth(p)).norm());
  return worst;
}

bool has_tetgen() {
  const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return std::filesystem::exists(folder / "ecorche-tetgen") ||
         std::filesystem::exists(folder.parent_path() / "ecorche-tetgen");
}

TEST(InteriorWarp, ABodyIntoItselfIsLeftWhereItIs) {
  const Figure figure;
  const HarmonicSolver solver(lattice_tissue(figure.skin, figure.bones));
  const auto same = [](const Vec3& p) { return p; };
  EXPECT_LT(furthest_off(solver.map_to(solver.move_nodes(pair_of(figure, figure))), same), 1e-12);
  EXPECT_LT(furthest_off(rbf_map(pair_of(figure, figure)), same), 1e-9);
}

TEST(InteriorWarp, ALatticeCarriesShiftsExactlyAndShearsNearly) {
  const Figure figure;
  const HarmonicSolver solver(lattice_tissue(figure.skin, figure.bones));
  const auto shift = [](const Vec3& p) { return Vec3(p + Vec3(0.1, -0.3, 0.05)); };
  EXPECT_LT(
      furthest_off(solver.map_to(solver.move_nodes(pair_of(figure, mapped(figure, shift)))), shift),
      1e-9);
  EXPECT_LT(furthest_off(solver.map_to(solver.move_nodes(pair_of(figure, mapped(figure, sheared)))),
                         sheared),
            2e-3);
}

TEST(InteriorWarp, RadialFunctionsCarryShearsExactly) {
  const Figure figure;
  EXPECT_LT(furthest_off(rbf_map(pair_of(figure, mapped(figure, sheared))), sheared), 1e-6);
}

TEST(InteriorWarp, BetweenSkinAndBoneDisplacementsLieBetween) {
  const Figure figure;
  Figure swollen = figure;  // the skin grows, the bone stays
  for (Eigen::Index i = 0; i < swollen.skin.V.rows(); ++i)
    swollen.skin.V.row(i) =
        Vec3(0.02, 1, 0) + 1.2 * (figure.skin.V.row(i).transpose() - Vec3(0.02, 1, 0));
  const HarmonicSolver solver(lattice_tissue(figure.skin, figure.bones));
  const InteriorMap map = solver.map_to(solver.move_nodes(pair_of(figure, swollen)));
  double before = 0;
  for (double r = 0.045; r < 0.1; r += 0.01) {
    const double moved = (map(Vec3(0.02, 1, r)) - Vec3(0.02, 1, r)).z();
    EXPECT_GT(moved, before) << r;  // further out goes further
    EXPECT_LT(moved, 0.0201) << r;
    before = moved;
  }
}

TEST(InteriorWarp, TetrahedraFillTheSkinAndCarryShearsExactly) {
  if (!has_tetgen()) GTEST_SKIP() << "ecorche-tetgen was not built (libtet1.5-dev)";
  const Figure figure;
  const TissueMesh mesh = tetgen_tissue(figure.skin, figure.bones);
  double volume = 0, bone = 0;
  const std::vector<double> volumes = tissue_volumes(mesh, mesh.V);
  for (std::size_t t = 0; t < volumes.size(); ++t) {
    EXPECT_GT(volumes[t], 0);
    volume += volumes[t];
    bone += mesh.in_bone[t] ? volumes[t] : 0;
  }
  EXPECT_NEAR(volume, mesh_volume(figure.skin), 1e-9);
  EXPECT_NEAR(bone, mesh_volume(figure.bones[0].mesh), 0.3 * mesh_volume(figure.bones[0].mesh));
  const HarmonicSolver solver(mesh);
  EXPECT_LT(furthest_off(solver.map_to(solver.move_nodes(pair_of(figure, mapped(figure, sheared)))),
                         sheared),
            1e-9);
}

TEST(InteriorWarp, WhatTetGenCannotTakeIsSaidAndLeavesUsRunning) {
  const Figure figure;
  setenv("ECORCHE_TETGEN", "/bin/false", 1);
  EXPECT_THROW(tetgen_tissue(figure.skin, figure.bones), UnfitError);
  setenv("ECORCHE_TETGEN", "/bin/true", 1);  // ends well and says nothing
  EXPECT_ANY_THROW(tetgen_tissue(figure.skin, figure.bones));
  setenv("ECORCHE_TETGEN", "/nowhere/at/all", 1);
  EXPECT_THROW(tetgen_tissue(figure.skin, figure.bones), UnfitError);
  unsetenv("ECORCHE_TETGEN");
  if (!has_tetgen()) return;
  TriMesh flat = figure.skin;  // no inside
  flat.V.col(2).setZero();
  EXPECT_ANY_THROW(tetgen_tissue(flat, {}));
}

TEST(InteriorWarp, TissueComesBackFromBytesAndDamageIsSeen) {
  const Figure figure;
  const TissueMesh mesh = lattice_tissue(figure.skin, figure.bones);
  std::string bytes = write_tissue_bytes(mesh);
  const TissueMesh back = read_tissue_bytes(bytes);
  EXPECT_EQ(back.V, mesh.V);
  EXPECT_EQ(back.T, mesh.T);
  EXPECT_EQ(back.in_bone, mesh.in_bone);
  ASSERT_EQ(back.anchors.size(), mesh.anchors.size());
  for (std::size_t n = 0; n < mesh.anchors.size(); ++n) {
    EXPECT_EQ(back.anchors[n].kind, mesh.anchors[n].kind);
    EXPECT_EQ(back.anchors[n].vertices, mesh.anchors[n].vertices);
  }
  bytes[bytes.size() / 2] ^= 1;
  EXPECT_THROW(read_tissue_bytes(bytes), InputError);
  EXPECT_THROW(read_tissue_bytes("short"), InputError);
}

}  // namespace
}  // namespace ecorche
