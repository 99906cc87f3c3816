// Laws of laid fascia, in the template: every sheet lies between muscles and skin, spans furrows
// without sinking in, and right sheets are the mirror images of left ones, but for a tenth.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/queries/nearest_surface.h"
#include "morph/fascia/lay_fascia.h"
#include "tests/morph/built_template.h"

namespace ecorche {
namespace {

TEST(LaidFascia, LiesBetweenMusclesAndSkin) {
  NEED_TEMPLATE();
  ASSERT_GE(tmpl.anatomy.fascia.size(), 20u);
  const MuscleSurface surface = make_muscle_surface(tmpl.anatomy);
  TriMesh muscles{{}, surface.F};
  update_muscle_surface(surface, rest_slices(tmpl.anatomy), muscles.V);
  const TriMesh skin = capped_skin(tmpl.tables.topology, tmpl.body.skin.V);
  const NearestSurface nearest(muscles);
  int inner = 0, sunk = 0;
  for (const FasciaSheet& sheet : tmpl.anatomy.fascia) {
    const std::vector<int> in_skin = winding_numbers(skin, sheet.V),
                           in_muscle = winding_numbers(muscles, sheet.V);
    EXPECT_EQ(std::count(in_skin.begin(), in_skin.end(), 0), 0) << sheet.name;
    for (int r = 2; r + 2 < sheet.rows; ++r)
      for (int c = 2; c + 2 < sheet.columns; ++c) {
        const int i = r * sheet.columns + c;
        ++inner;
        sunk += in_muscle[i] != 0 && nearest.nearest(sheet.V.row(i)).distance > 1e-3;
      }
  }
  EXPECT_LT(sunk, 0.01 * inner);
}

// The tensor's tendon is the tract, which is drawn as a sheet: a band of its own would come out of
// the thigh as the hip bends.
TEST(LaidFascia, NoBandOfTheTensorLiesBesideTheTract) {
  NEED_TEMPLATE();
  const auto tensor =
      std::ranges::find(tmpl.anatomy.muscles, "tensor_fasciae_latae_l", &Muscle::name);
  ASSERT_NE(tensor, tmpl.anatomy.muscles.end());
  int below = 0;
  for (const Slice& slice : tensor->strips.at(0).slices) {
    if (slice.s < 0.5) continue;
    ++below;
    EXPECT_LT(slice.radii.maxCoeff(), 0.006) << slice.s;
  }
  EXPECT_GT(below, 3);
  const auto tract =
      std::ranges::find(tmpl.anatomy.fascia, "iliotibial_tract_l", &FasciaSheet::name);
  ASSERT_NE(tract, tmpl.anatomy.fascia.end());
  const TriMesh sheet{tract->V, grid_triangles(tract->rows, tract->columns)};
  EXPECT_LT(NearestSurface(sheet).nearest(tensor->strips[0].path[1].rest).distance, 0.03);
}

TEST(LaidFascia, RightIsTheMirrorImageOfLeft) {
  NEED_TEMPLATE();
  const auto& sheets = tmpl.anatomy.fascia;
  for (std::size_t n = 0; n + 1 < sheets.size(); ++n) {
    if (sheets[n].side != Side::left) continue;
    const FasciaSheet &left = sheets[n], &right = sheets[n + 1];
    ASSERT_EQ(left.rows, right.rows) << left.name;
    ASSERT_EQ(left.columns, right.columns) << left.name;
    std::vector<double> apart;
    for (int r = 0; r < left.rows; ++r)
      for (int c = 0; c < left.columns; ++c) {
        // seen from outside, a mirror image's rows run the other way
        const Vec3 a = left.V.row(r * left.columns + c),
                   b = right.V.row(r * left.columns + left.columns - 1 - c);
        apart.push_back((a - Vec3(-b.x(), b.y(), b.z())).norm());
      }
    // where a muscle ends, rays of one side may just miss it
    const auto most = apart.begin() + std::ptrdiff_t(apart.size() * 9 / 10);
    std::nth_element(apart.begin(), most, apart.end());
    EXPECT_LT(*most, 1.5e-3) << left.name;
  }
}

TEST(LaidFascia, OfABoneThatIsNotThereIsLeftOut) {
  NEED_TEMPLATE();
  Anatomy anatomy = tmpl.anatomy;
  std::erase_if(anatomy.bones, [](const Bone& bone) { return bone.name == "patella_l"; });
  const SkinRays skin(capped_skin(tmpl.tables.topology, tmpl.body.skin.V));
  const auto laid = lay_fascia(tmpl.tables.fascia, anatomy, skin);
  EXPECT_EQ(laid.size() + 3, tmpl.anatomy.fascia.size());
  for (const FasciaSheet& sheet : laid)
    for (const char* name :
         {"patellar_ligament_l", "medial_patellar_retinaculum_l", "lateral_patellar_retinaculum_l"})
      EXPECT_NE(sheet.name, name);
}

}  // namespace
}  // namespace ecorche
