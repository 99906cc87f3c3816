// What is inside an edited skin: an affine change of the skin is one of everything in it, and the
// character stays one.
#include "skinning/character/live_character.h"

#include <gtest/gtest.h>

#include "anatomy/muscles/action_line.h"
#include "tests/morph/built_template.h"

namespace ecorche {
namespace {

TEST(LiveAnatomy, AScaledSkinScalesAllThatIsInIt) {
  NEED_TEMPLATE();
  const Character before{tmpl.anatomy, tmpl.body};
  constexpr double kScale = 1.1;
  const Vec3 shift(0.2, 0.1, -0.3);
  LiveAnatomy live(before);
  live.follow((kScale * before.body.skin.V).rowwise() + shift.transpose());
  const Character& after = live.character();
  const auto there = [&](const Vec3& p) -> Vec3 { return kScale * p + shift; };

  const std::vector<Vec3> from = rest_positions(before.anatomy.skeleton),
                          to = rest_positions(after.anatomy.skeleton);
  for (std::size_t j = 0; j < from.size(); ++j) {
    EXPECT_LT((to[j] - there(from[j])).norm(), 1e-4) << after.anatomy.skeleton.joints[j].name;
    EXPECT_LT(
        (after.anatomy.skeleton.joints[j].axes - before.anatomy.skeleton.joints[j].axes).norm(),
        5e-3);
  }
  for (std::size_t b = 0; b < before.anatomy.bones.size(); ++b)
    EXPECT_LT((after.anatomy.bones[b].mesh.V -
               ((kScale * before.anatomy.bones[b].mesh.V).rowwise() + shift.transpose()))
                  .rowwise()
                  .norm()
                  .maxCoeff(),
              1e-4);
  for (std::size_t m = 0; m < before.anatomy.muscles.size(); ++m) {
    const Muscle &was = before.anatomy.muscles[m], &is = after.anatomy.muscles[m];
    EXPECT_NEAR(is.volume / was.volume, kScale * kScale * kScale, 5e-3) << was.name;
    for (std::size_t s = 0; s < was.strips.size(); ++s) {
      EXPECT_NEAR(is.strips[s].rest_length / was.strips[s].rest_length, kScale, 5e-3) << was.name;
      for (std::size_t w = 0; w < was.strips[s].wraps.size(); ++w)
        EXPECT_LT((is.strips[s].wraps[w].radii - kScale * was.strips[s].wraps[w].radii).norm(),
                  1e-4)
            << was.name;
    }
  }
  const std::vector<Ellipse> sections = rest_slices(before.anatomy);
  for (std::size_t k = 0; k < sections.size(); ++k)
    EXPECT_LT((live.slices()[k].center - there(sections[k].center)).norm(), 5e-4) << k;
}

TEST(LiveAnatomy, SectionsAreWhereTheStripsSay) {
  NEED_TEMPLATE();
  const Character before{tmpl.anatomy, tmpl.body};
  Points skin = before.body.skin.V;
  for (Eigen::Index v = 0; v < skin.rows(); ++v)
    skin(v, 0) *= 1 + 0.1 * skin(v, 1);  // broader the higher: no affine change
  LiveAnatomy live(before);
  live.follow(skin);
  validate(live.character().anatomy);
  const std::vector<Ellipse> said = rest_slices(live.character().anatomy);
  ASSERT_EQ(said.size(), live.slices().size());
  for (std::size_t k = 0; k < said.size(); ++k) {
    EXPECT_LT((said[k].center - live.slices()[k].center).norm(), 1e-9) << k;
    EXPECT_LT((said[k].radii - live.slices()[k].radii).norm(), 1e-9) << k;
  }
  // And back: nothing is kept of where it was.
  live.follow(before.body.skin.V);
  const std::vector<Ellipse> back = rest_slices(before.anatomy);
  for (std::size_t k = 0; k < back.size(); ++k)
    EXPECT_LT((live.slices()[k].center - back[k].center).norm(), 1e-5) << k;
}

}  // namespace
}  // namespace ecorche
