// The skin's places on a texture: every corner has one, seams are split and nothing else is.
#include "anatomy/base_mesh/skin_texture.h"
#include "anatomy/base_mesh/refined_skin.h"

#include <gtest/gtest.h>

#include <set>

#include "anatomy/geometry/mesh_measures.h"
#include "tests/body_fixture.h"

namespace ecorche {
namespace {

double area_on(const SkinTexture& texture, Eigen::Index f) {
  const Eigen::Vector2d a = texture.places.row(texture.F(f, 0)).cast<double>(),
                        b = texture.places.row(texture.F(f, 1)).cast<double>(),
                        c = texture.places.row(texture.F(f, 2)).cast<double>();
  return 0.5 * std::abs((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
}

// Laws of any texture of a skin.
void expect_sound(const SkinTexture& texture, const Triangles& F, int vertices) {
  ASSERT_EQ(texture.F.rows(), F.rows());
  ASSERT_EQ(texture.places.rows(), Eigen::Index(texture.vertex.size()));
  for (int i = 0; i < vertices; ++i) ASSERT_EQ(texture.vertex[i], i);
  std::set<int> used;
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(texture.vertex[texture.F(f, k)], F(f, k)) << f;
      used.insert(texture.F(f, k));
    }
  EXPECT_EQ(used.size(), texture.vertex.size());
  EXPECT_GT(texture.places.minCoeff(), 0);
  EXPECT_LT(texture.places.maxCoeff(), 1);
  std::set<std::tuple<int, float, float>> distinct;
  for (Eigen::Index i = 0; i < texture.places.rows(); ++i)
    distinct.emplace(texture.vertex[i], texture.places(i, 0), texture.places(i, 1));
  EXPECT_EQ(distinct.size(), texture.vertex.size());
}

class SkinTextureOfPackage : public BodyFixture {};

TEST_F(SkinTextureOfPackage, SplitsTheSeamsAlone) {
  const SkinTexture texture = skin_texture(package());
  expect_sound(texture, package().triangles, package().skin_size);
  EXPECT_EQ(texture.vertex.size(), 14517u);
  // A triangle that ran across a seam would be drawn out over the texture.
  for (Eigen::Index f = 0; f < texture.F.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      ASSERT_LT(
          (texture.places.row(texture.F(f, k)) - texture.places.row(texture.F(f, (k + 1) % 3)))
              .norm(),
          0.07f)
          << f;
}

TEST_F(SkinTextureOfPackage, FineTrianglesFillTheirParents) {
  const SkinTexture base = skin_texture(package());
  const Refinement fine = refine_skin(package());
  const SkinTexture texture = skin_texture(base, fine);
  expect_sound(texture, fine.F, int(fine.map.rows()));
  std::vector<double> area(base.F.rows(), 0);
  for (Eigen::Index f = 0; f < texture.F.rows(); ++f) {
    const std::size_t parent = fine.parents[f];
    const double one = area_on(texture, f);
    area[parent] += one;
    ASSERT_NEAR(one, area_on(base, Eigen::Index(parent)) / 9, 1e-9) << f;
  }
  for (Eigen::Index f = 0; f < base.F.rows(); ++f) ASSERT_NEAR(area[f], area_on(base, f), 1e-8);
}

}  // namespace
}  // namespace ecorche
