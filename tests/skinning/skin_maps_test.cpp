// Laws of maps of a detailed skin: nothing on a skin without details, the height and slope of a
// known ramp, the same seen from a mirrored texture.
#include "skinning/bake/skin_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace ecorche {
namespace {

// A square sheet of a metre in the x-y plane, facing z, that fills its texture. `mirrored`: right
// on the sheet is left on the texture.
DetailedSkin sheet_with(double amplitude, bool mirrored) {
  constexpr int n = 65;
  DetailedSkin out{{Points(n * n, 3), Triangles(2 * (n - 1) * (n - 1), 3)}, {}, {}};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      out.smooth.V.row(i * n + j) << double(j) / (n - 1), double(i) / (n - 1), 0;
  Eigen::Index f = 0;
  for (int i = 0; i + 1 < n; ++i)
    for (int j = 0; j + 1 < n; ++j) {
      const int a = i * n + j;
      out.smooth.F.row(f++) << a, a + 1, a + n + 1;
      out.smooth.F.row(f++) << a, a + n + 1, a + n;
    }
  for (Eigen::Index t = 0; t < out.smooth.F.rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto p = out.smooth.V.row(out.smooth.F(t, k));
      out.corners.emplace_back(float(mirrored ? 1 - p[0] : p[0]), float(p[1]));
    }
  out.detailed = out.smooth.V;
  for (Eigen::Index v = 0; v < out.detailed.rows(); ++v)
    out.detailed(v, 2) = amplitude * (out.detailed(v, 0) - 0.5);
  return out;
}

TEST(SkinMaps, NothingOnASkinWithoutDetails) {
  const SkinMaps maps = skin_maps(sheet_with(0, false), 64);
  ASSERT_EQ(maps.displacement.size(), 64u * 64u);
  for (std::size_t i = 0; i < maps.displacement.size(); ++i) {
    EXPECT_EQ(maps.displacement[i], 128);
    EXPECT_EQ(maps.normals[3 * i], 128);
    EXPECT_EQ(maps.normals[3 * i + 1], 128);
    EXPECT_EQ(maps.normals[3 * i + 2], 255);
  }
}

TEST(SkinMaps, HeightAndSlopeOfARamp) {
  for (const bool mirrored : {false, true}) {
    const SkinMaps maps = skin_maps(sheet_with(0.5, mirrored), 64);
    EXPECT_NEAR(maps.range, 0.25, 1e-9);
    const double right = (mirrored ? 0.5 : -0.5) / std::hypot(1, 0.5);
    for (int y = 8; y < 56; ++y)
      for (int x = 8; x < 56; ++x) {
        const std::size_t i = std::size_t(64 * y + x);
        const double along = ((x + 0.5) / 64 - 0.5) * (mirrored ? -1 : 1);
        EXPECT_NEAR((maps.displacement[i] - 128) / 127.0 * maps.range, 0.5 * along, 2e-3);
        EXPECT_NEAR((maps.normals[3 * i] - 128) / 127.0, right, 0.01);
        EXPECT_NEAR(maps.normals[3 * i + 1], 128, 1);
      }
  }
}

TEST(SkinMaps, RefusesWhatDoesNotGoTogether) {
  DetailedSkin skin = sheet_with(0, false);
  EXPECT_THROW(skin_maps(skin, 0), std::invalid_argument);
  skin.corners.pop_back();
  EXPECT_THROW(skin_maps(skin, 16), std::invalid_argument);
}

}  // namespace
}  // namespace ecorche
