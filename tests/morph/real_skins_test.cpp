// The family of real people's skins is as the table of scanned adults says.
#include "tests/morph/real_skins.h"

#include <gtest/gtest.h>

#include <cmath>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/self_intersections.h"
#include "morph/fit/fit_character.h"
#include "morph/template/template_cache.h"
#include "tests/body_fixture.h"
#include "tests/some_of.h"

namespace ecorche {
namespace {

class RealSkinsTest : public BodyFixture {
 protected:
  static const BodyModel& model() {
    static const BodyModel once(package());
    return once;
  }
  static const RealSkins& family() {
    static const RealSkins once(model());
    return once;
  }
};

TEST_F(RealSkinsTest, AreSpreadAsTheTableSays) {
  constexpr unsigned kSkins = 12;
  std::array<double, 12> count{}, sum{}, squares{};
  double even = 0, all = 0;
  for (unsigned seed = 0; seed < kSkins; ++seed) {
    const RealSkin skin = family().make(seed);
    for (std::size_t i = 0; i < family().regions().size(); ++i) {
      const int r = family().regions()[i];
      if (r < 0) continue;
      const double d = skin.moved[Eigen::Index(i)], other = skin.moved[package().mirror[i]];
      count[std::size_t(r)] += 1;
      sum[std::size_t(r)] += d;
      squares[std::size_t(r)] += d * d;
      even += (d + other) * (d + other) / 4;
      all += d * d;
    }
  }
  for (std::size_t r = 0; r < count.size(); ++r) {
    const SkinResidual& asked = kSkinResiduals[r];
    const double mean = sum[r] / count[r], sd = std::sqrt(squares[r] / count[r] - mean * mean);
    EXPECT_NEAR(sd, asked.sd, 0.15 * asked.sd) << asked.region;
    EXPECT_NEAR(mean, asked.mean, 0.45 * asked.sd) << asked.region;
  }
  EXPECT_GT(even / all, 0.6);  // (mirrored + half of the rest)
  EXPECT_LT(even / all, 0.95);
}

TEST_F(RealSkinsTest, AreTheSameEachTimeAndSound) {
  EXPECT_EQ(family().make(3).body.skin.V, RealSkins(model()).make(3).body.skin.V);
  for (const unsigned seed : {3U, 4U}) {
    const RealSkin skin = family().make(seed);
    EXPECT_TRUE(skin.body.skin.V.allFinite());
    const Body body = make_body(model(), skin.spec);
    const TriMesh before = capped_skin(package(), body.skin.V),
                  after = capped_skin(package(), skin.body.skin.V);
    EXPECT_LE(count_self_intersections(after.F, after.V),
              count_self_intersections(before.F, before.V));
  }
  EXPECT_NE(family().make(3).body.skin.V, family().make(4).body.skin.V);
}

// Bones leave every muscle whole: the law that `check` states for each muscle by itself. The sheets
// over the ribs, the spines' small muscles and those below the skull are in the way of bones most.
TEST_F(RealSkinsTest, MusclesGoRoundBones) {
  const Template own = read_template(test_assets());
  for (const unsigned seed : some_of<unsigned>({1U, 3U}, 1)) {
    FittingOptions options;
    options.tissues = false;
    const FittedCharacter fitted = fit_character(own, family().make(seed).body, package(), options);
    const FillReport& fill = fitted.report.fill;
    EXPECT_FALSE(fill.pierced_muscle.empty());
    EXPECT_LE(fill.pierced_share, 0.05) << seed << " " << fill.pierced_muscle;
    EXPECT_LE(fill.points_outside, 5e-4 * fill.points) << seed;
    for (const MissedTarget& target : missed_targets(fitted.report))
      EXPECT_NE(target.name, "muscle_pierced") << target.what;
  }
}

}  // namespace
}  // namespace ecorche
