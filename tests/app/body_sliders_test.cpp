// Sliders on both sexes: what is shown while one moves stays in the body, what is shown after it is
// what `fit` makes, and so is what is written.
#include "app/studio/body_sliders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>

#include "anatomy/errors.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/muscles/action_line.h"
#include "morph/fit/fit_character.h"
#include "morph/shapes/body_model.h"
#include "skinning/character/live_character.h"
#include "skinning/files/character_read.h"
#include "tests/morph/built_template.h"
#include "tests/some_of.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

using Asked = std::vector<std::optional<double>>;

// An average person of one sex, with bones and muscles; made once.
const Character& person(const Template& tmpl, Sex sex) {
  static std::map<Sex, Character> made;
  const auto [it, fresh] = made.try_emplace(sex);
  if (fresh) {
    BodySpec average;
    average.sex = sex;
    const BodyPackage package = read_body_package(test_assets());
    const Body body = make_body(package, average);
    it->second = {fit_character(tmpl, body, package, {.tissues = false}).anatomy, body};
  }
  return it->second;
}

// Points outside a closed skin.
long outside(const TriMesh& closed, const Points& points) {
  const std::vector<int> winding = winding_numbers(closed, points);
  return std::count(winding.begin(), winding.end(), 0);
}

long bones_outside(const TriMesh& closed, const Anatomy& anatomy) {
  long out = 0;
  for (const Bone& bone : anatomy.bones) out += outside(closed, bone.mesh.V);
  return out;
}

double furthest_apart(const Anatomy& a, const Anatomy& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.bones.size(); ++i)
    most = std::max(most, (a.bones[i].mesh.V - b.bones[i].mesh.V).rowwise().norm().maxCoeff());
  return most;
}

// Where an extreme can be, and then anywhere within the sliders' ranges, one or two at a time.
std::vector<Asked> settings(const std::vector<Slider>& sliders, int drawn) {
  const auto at = [&](const std::string& name) {
    const auto found = std::ranges::find_if(
        sliders, [&](const Slider& slider) { return slider.name.starts_with(name); });
    return std::size_t(found - sliders.begin());
  };
  const std::size_t stature = at("body height"), waist = at("waist girth"), mass = at("body mass");
  std::vector<Asked> out(4, Asked(sliders.size()));
  out[0][stature] = sliders[stature].high;
  out[1][stature] = 1.50;
  out[2][stature] = 1.41, out[2][waist] = 1.15;
  out[3][mass] = 117;
  std::mt19937 draw(20240611);
  for (int i = 0; i < drawn; ++i) {
    Asked& asked = out.emplace_back(sliders.size());
    for (int targets = 1 + int(draw() % 2); targets > 0; --targets) {
      const std::size_t k = draw() % at("fat");
      asked[k] = std::uniform_real_distribution<double>(sliders[k].low, sliders[k].high)(draw);
    }
  }
  return out;
}

std::string in_words(const std::vector<Slider>& sliders, const Asked& asked) {
  std::string out;
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (asked[i])
      out += fmt::format("{} {:.1f} {}  ", sliders[i].name, sliders[i].scale * *asked[i],
                         sliders[i].unit);
  return out;
}

class BodySlidersTest : public testing::TestWithParam<Sex> {};

TEST_P(BodySlidersTest, bones_that_go_along_with_the_skin_stay_in_it) {
  NEED_TEMPLATE();
  const Character& start = person(tmpl, GetParam());
  const BodyPackage package = read_body_package(test_assets());
  const BodySliders sliders(test_assets(), start, tmpl);
  const std::vector<Slider> shown = sliders.sliders();
  LiveAnatomy live(start);
  for (const Asked& asked : settings(shown, thorough() ? 8 : 2)) {
    const Body body = sliders.solve(asked);
    live.follow(body.skin.V);
    const Anatomy &carried = live.character().anatomy, fitted = fit_anatomy(tmpl, body).anatomy;
    const TriMesh closed = capped_skin(package, body.skin.V);
    EXPECT_LE(bones_outside(closed, carried), 30) << in_words(shown, asked);
    EXPECT_LT(furthest_apart(carried, fitted), 0.12) << in_words(shown, asked);
  }
}

TEST_P(BodySlidersTest, what_is_shown_is_what_fit_makes) {
  NEED_TEMPLATE();
  const BodyPackage package = read_body_package(test_assets());
  BodySliders sliders(test_assets(), person(tmpl, GetParam()), tmpl);
  const std::vector<Slider> shown = sliders.sliders();
  const std::vector<Asked> asked = settings(shown, 0);
  for (const Asked& overtaken : asked) sliders.ask(overtaken);  // only the last one counts
  const Asked& last = GetParam() == Sex::male ? asked[0] : asked[3];
  sliders.ask(last);
  EXPECT_TRUE(sliders.busy());
  sliders.wait();
  ASSERT_EQ(sliders.problem(), "");
  const std::shared_ptr<const SlidBody> body = sliders.shown();
  EXPECT_EQ(body->stage, SlidBody::Stage::whole);
  for (std::size_t i = 0; i < last.size(); ++i)
    if (last[i])
      EXPECT_NEAR(body->achieved[i], *last[i], 1e-3 * std::abs(*last[i])) << in_words(shown, last);

  const FittedCharacter fitted =
      fit_character(tmpl, sliders.solve(last), package, {.tissues = false});
  const Anatomy &is = body->character.anatomy, &wanted = fitted.anatomy;
  EXPECT_EQ(furthest_apart(is, wanted), 0);
  EXPECT_EQ(body->missed.size(), missed_targets(fitted.report).size());
  const std::vector<Ellipse> slices = rest_slices(wanted);
  ASSERT_EQ(body->rest.slices.size(), slices.size());
  for (std::size_t k = 0; k < slices.size(); ++k)
    ASSERT_EQ(body->rest.slices[k].center, slices[k].center) << k;
  EXPECT_EQ(bones_outside(capped_skin(package, body->character.body.skin.V), is), 0);

  // And drawn where it is.
  Scene scene;
  update_scene(body->model, body->rest, nullptr, {}, {}, 1, scene);
  float off = 0;
  for (const DrawItem& item : scene.list.items) {
    const Part part = part_of(item.part);
    if (part.kind != Part::Kind::bone) continue;
    const Points& V = is.bones[part.index].mesh.V;
    const DrawMesh& mesh = scene.list.meshes[item.mesh];
    for (Eigen::Index i = 0; i < V.rows(); ++i)
      off = std::max(off, ((item.X_WM * mesh.positions[i].homogeneous()).head<3>() -
                           V.row(i).transpose().cast<float>())
                              .norm());
  }
  EXPECT_LT(off, 1e-4f);

  sliders.ask(Asked(shown.size()));
  sliders.wait();
  EXPECT_EQ(furthest_apart(sliders.shown()->character.anatomy, person(tmpl, GetParam()).anatomy), 0)
      << "let go, it is the person again";
}

INSTANTIATE_TEST_SUITE_P(BothSexes, BodySlidersTest,
                         testing::ValuesIn(some_of<Sex>({Sex::female, Sex::male}, 0, 2)),
                         [](const auto& sex) { return sex.param == Sex::male ? "men" : "women"; });

TEST(BodySliders, what_is_written_is_fitted_and_judged) {
  NEED_TEMPLATE();
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("ecorche_sliders_{}.glb", ::getpid());
  const BodySliders sliders(test_assets(), person(tmpl, Sex::male), tmpl);
  const Asked stout = settings(sliders.sliders(), 0)[2];
  Report report;
  const std::vector<MissedTarget> missed = sliders.write(stout, file, report);
  const BodyPackage package = read_body_package(test_assets());
  const FittedCharacter fitted =
      fit_character(tmpl, sliders.solve(stout), package, {.tissues = false});
  EXPECT_EQ(missed.size(), missed_targets(fitted.report).size());
  const Character written = read_character(file);
  EXPECT_LT(furthest_apart(written.anatomy, fitted.anatomy), 1e-6);
  std::filesystem::remove(file);
}

TEST(BodySliders, another_anatomy_than_the_templates_is_refused) {
  NEED_TEMPLATE();
  Character other = person(tmpl, Sex::male);
  other.anatomy.muscles.pop_back();
  EXPECT_THROW(BodySliders(test_assets(), other, tmpl), UnfitError);
}

}  // namespace
}  // namespace ecorche
