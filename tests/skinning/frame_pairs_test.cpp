#include <gtest/gtest.h>

#include "plain_skeleton.h"
#include "skinning/bind/weight_rules.h"

using namespace ecorche;

// In people a raised arm narrows its root: half-way frames count less there than at a hip.
TEST(FramePairs, CountLessAboutTheGirdle) {
  const Skeleton skeleton = plain_skeleton();
  const std::vector<Vec3> origins = rest_positions(skeleton);
  const auto weight_between = [&](const char* upper, const char* lower) {
    const int a = find_joint(skeleton, upper), b = find_joint(skeleton, lower);
    TriMesh skin{Points(1, 3), Triangles(0, 3)};
    skin.V.row(0) = origins[std::size_t(b)] + Vec3(0, 0, 0.05);
    std::vector<WeightRow> rows = {{{a, 0.5}, {b, 0.5}}};
    const std::vector<FramePair> pairs = add_frame_pairs(skeleton, skin, {}, rows);
    EXPECT_EQ(pairs.size(), 1u) << lower;
    return rows[0].back().weight;
  };
  EXPECT_NEAR(weight_between("pelvis", "hip_l"), 0.5, 1e-9);
  EXPECT_NEAR(weight_between("shoulder_r", "elbow_r"), 0.5, 1e-9);
  EXPECT_LT(weight_between("scapula_l", "shoulder_l"), 0.25);
  EXPECT_LT(weight_between("thorax", "clavicle_r"), 0.25);
}
