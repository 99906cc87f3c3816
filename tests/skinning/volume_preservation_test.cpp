// Laws of where the skin gives back the volume that it has lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/vertex_normals.h"
#include "skinning/settle/volume_preservation.h"
#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

constexpr double kWaist = 1.3;    // m, height of the joint "thorax" of test::make_arm()
constexpr double kPassage = 0.1;  // m, about the waist, in which skin passes from pelvis to chest

// A trunk of 0.1 m radius and its regions. Its halves are the pelvis' and the chest's.
struct Trunk {
  Skeleton skeleton = test::make_arm().anatomy.skeleton;
  TriMesh mesh;
  VolumeRegions regions;

  Trunk() {
    std::vector<Vec2> profile;
    for (int k = 1; k <= 20; ++k) profile.emplace_back(0, 0.1 * k / 20);
    for (int k = 1; k < 100; ++k) profile.emplace_back(k / 100.0, 0.1);
    for (int k = 20; k >= 1; --k) profile.emplace_back(1, 0.1 * k / 20);
    mesh = test::lathe(Vec3(0, kWaist - 0.5, 0), Vec3::UnitY(), profile, 48);
    std::vector<JointWeights> weights;
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      const double chest = std::clamp(0.5 + (mesh.V(i, 1) - kWaist) / kPassage, 0.0, 1.0);
      weights.push_back({Influence{0, 1 - chest}, {1, chest}, {}, {}});
    }
    const std::vector<double> tissue(mesh.V.rows(), 0.04);
    regions = make_volume_regions(skeleton, positions(mesh.V), triangles(), weights, tissue);
  }

  std::span<const int> triangles() const { return {mesh.F.data(), std::size_t(mesh.F.size())}; }

  static std::vector<float> positions(const Points& V) {
    std::vector<float> out;
    for (Eigen::Index i = 0; i < V.rows(); ++i)
      for (int k = 0; k < 4; ++k) out.push_back(k < 3 ? float(V(i, k)) : 1);
    return out;
  }

  // The skin with its girth at heights that `pressed` tells made smaller by 3 %.
  template <class Pressed>
  Points press(const Pressed& pressed) const {
    Points V = mesh.V;
    for (Eigen::Index i = 0; i < V.rows(); ++i)
      if (pressed(V(i, 1))) V(i, 0) *= 0.97, V(i, 2) *= 0.97;
    return V;
  }

  Points restored(const Points& V) const {
    RelaxedSkin skin;
    skin.positions = positions(V);
    skin.normals.resize(skin.positions.size());
    vertex_normals(skin.positions, triangles(), skin.normals);
    skin.openness.assign(V.rows(), 1);
    std::vector<Transform> X_WJ;
    forward_kinematics(skeleton, rest_pose(skeleton), X_WJ);
    restore_volumes(regions, X_WJ, skin);
    Points out(V.rows(), 3);
    for (Eigen::Index i = 0; i < out.rows(); ++i)
      for (int k = 0; k < 3; ++k) out(i, k) = double(skin.positions[4 * i + k]);
    return out;
  }

  double volume(const Points& V) const { return mesh_volume({V, mesh.F}); }

  // m, farthest that vertices at heights that `there` tells lie from rest.
  template <class There>
  double moved(const Points& V, const There& there) const {
    double out = 0;
    for (Eigen::Index i = 0; i < V.rows(); ++i)
      if (there(mesh.V(i, 1))) out = std::max(out, (V.row(i) - mesh.V.row(i)).norm());
    return out;
  }
};

bool is_chest(double y) { return y > kWaist + kPassage; }
bool is_belly(double y) { return y < kWaist - kPassage; }

// What `part` loses is given back, and `other` moves by less than `moved`, m.
template <class Part, class Other>
void expect_given_back(const Part& part, const Other& other, double moved) {
  const Trunk trunk;
  const Points pressed = trunk.press(part), V = trunk.restored(pressed);
  const double rest = trunk.volume(trunk.mesh.V);
  EXPECT_LT(trunk.volume(pressed) / rest, 0.98);
  EXPECT_NEAR(trunk.volume(V) / rest, 1, 2e-3);
  EXPECT_LT(trunk.moved(V, other), moved);
}

TEST(BodyVolumes, ChestAloneGivesBackWhatItHasLost) { expect_given_back(is_chest, is_belly, 1e-5); }

TEST(BodyVolumes, BellyAloneGivesBackWhatItHasLost) { expect_given_back(is_belly, is_chest, 2e-4); }

// Where half of the skin is the belly's its thick flesh does not pay for the chest.
TEST(BodyVolumes, SkinThatIsHalfTheBellysLeavesTheChestAlone) {
  const auto is_passage = [](double y) { return y < kWaist && y > kWaist - kPassage; };
  expect_given_back(is_chest, is_passage, 1e-5);
}

// A belly keeps what it gains, within bounds.
TEST(BodyVolumes, BellyMayGainALittle) {
  const Trunk trunk;
  const auto gained = [&](double girth) {
    Points V = trunk.mesh.V;
    for (Eigen::Index i = 0; i < V.rows(); ++i)
      if (is_belly(V(i, 1))) V(i, 0) *= girth, V(i, 2) *= girth;
    const double rest = trunk.volume(trunk.mesh.V);
    return std::pair{trunk.volume(V) / rest - 1, trunk.volume(trunk.restored(V)) / rest - 1};
  };
  const auto [little, left] = gained(1.004);
  EXPECT_GT(little, 0.002);
  EXPECT_NEAR(left, little, 1e-6);
  const auto [much, bounded] = gained(1.04);
  EXPECT_GT(much, 0.03);
  EXPECT_LT(bounded, 0.012);
}

}  // namespace
}  // namespace ecorche
