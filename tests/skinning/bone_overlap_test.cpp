// The space that bones share is what their meshes share, pair by pair.
#include "skinning/checks/bone_overlap.h"

#include <gtest/gtest.h>

namespace ecorche {
namespace {

// Closed, faces outwards.
Bone box(const char* name, const Vec3& low, const Vec3& high) {
  Bone out;
  out.name = name;
  out.mesh = {Points(8, 3), Triangles(12, 3)};
  for (int i = 0; i < 8; ++i)
    out.mesh.V.row(i) << (i & 1 ? high : low).x(), (i & 2 ? high : low).y(),
        (i & 4 ? high : low).z();
  out.mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2,
      4, 6, 1, 3, 5, 3, 7, 5;
  return out;
}

TEST(BoneOverlap, IsTheSpaceThatBothTake) {
  const std::vector<Bone> bones{box("alone", {0.5, 0, 0}, {0.6, 0.1, 0.1}),
                                box("femur", {0, 0, 0}, {0.04, 0.1, 0.04}),
                                box("patella", {0.03, 0.04, 0.01}, {0.05, 0.06, 0.03}),
                                box("tibia", {0, -0.1, 0}, {0.04, 0.001, 0.04})};
  const BoneOverlap found = measure_bone_overlap(bones, 1e-3);
  ASSERT_EQ(found.pairs.size(), 2u);
  EXPECT_EQ(found.pairs[0].a, "femur");
  EXPECT_EQ(found.pairs[0].b, "patella");
  EXPECT_NEAR(found.pairs[0].volume, 4e-6, 0.2e-6);
  EXPECT_EQ(found.pairs[1].b, "tibia");
  EXPECT_NEAR(found.pairs[1].volume, 1.6e-6, 0.1e-6);
  EXPECT_NEAR(found.share, 5.6e-6 / (1e-3 + 1.6e-4 + 8e-6 + 1.616e-4), 3e-4);
}

TEST(BoneOverlap, IsNoneOfBonesApart) {
  const BoneOverlap found = measure_bone_overlap(
      {box("a", {0, 0, 0}, {0.02, 0.02, 0.02}), box("b", {0.021, 0, 0}, {0.04, 0.02, 0.02})}, 1e-3);
  EXPECT_TRUE(found.pairs.empty());
  EXPECT_EQ(found.share, 0);
}

}  // namespace
}  // namespace ecorche
