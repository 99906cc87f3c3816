#include "morph/shapes/modify_body.h"

#include "anatomy/files/package_archive.h"
#include "morph/shapes/shape_space_cache.h"
#include "tests/body_fixture.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

class ModifyTest : public BodyFixture {
 protected:
  static const TapeMeasure& tape() {
    static const TapeMeasure once(package(),
                                  read_measure_table(package(), test_assets().tables / "body"));
    return once;
  }
  static const ShapeSpace& space() {
    static const ShapeSpace once = read_shape_space(package(), tape(), Sex::female);
    return once;
  }
  // A person with something of her own that no space knows: a dent in the belly.
  static Points person() {
    std::vector<MeasureTarget> asked{
        {at("stature"), 1.66}, {at("waist_girth"), 0.80}, {at("hip_girth"), 1.02}};
    Points out = solve_measures(tape(), space(), asked).points;
    const int navel = tape().measure(at("waist_girth")).vertices[0];
    const Vec3 middle = out.row(navel);
    for (int v = 0; v < package().skin_size; ++v)
      out(v, 2) -= 0.004 * std::exp(-(out.row(v).transpose() - middle).squaredNorm() / 4e-4);
    return out;
  }
  static int at(const char* id) { return tape().table().at(id); }
};

TEST_F(ModifyTest, FatPercentageIsTheFormulasOfBothSexes) {
  const Points skin = person();
  const auto inches = [&](const char* id) { return tape().take(at(id), skin) / 0.0254; };
  EXPECT_NEAR(
      fat_percentage(tape(), Sex::female, skin),
      163.205 * std::log10(inches("waist_girth") + inches("hip_girth") - inches("neck_girth")) -
          97.684 * std::log10(inches("stature")) - 78.387,
      1e-9);
  EXPECT_NEAR(fat_percentage(tape(), Sex::male, skin),
              86.010 * std::log10(inches("waist_girth") - inches("neck_girth")) -
                  70.041 * std::log10(inches("stature")) + 36.76,
              1e-9);
}

TEST_F(ModifyTest, DerivativesAreThoseOfTheFigures) {
  const Points skin = person();
  const auto along = [&](const MeasureGradient& g, const Points& move) {
    double sum = 0;
    for (const auto& [v, by] : g) sum += by.dot(move.row(v));
    return sum;
  };
  constexpr double kStep = 1e-3;
  const Points move =
      space_points(space(), Eigen::VectorXd::Unit(space().basis.cols(), 1)) - space().mean;
  for (const Sex sex : {Sex::male, Sex::female}) {
    MeasureGradient fat;
    fat_percentage(tape(), sex, skin, &fat);
    const double numeric = (fat_percentage(tape(), sex, skin + kStep * move) -
                            fat_percentage(tape(), sex, skin - kStep * move)) /
                           (2 * kStep);
    EXPECT_NEAR(along(fat, move), numeric, 0.02 * std::abs(numeric) + 1e-4);
  }
  MeasureGradient ratio;
  hip_waist_ratio(tape(), skin, &ratio);
  const double numeric = (hip_waist_ratio(tape(), skin + kStep * move) -
                          hip_waist_ratio(tape(), skin - kStep * move)) /
                         (2 * kStep);
  EXPECT_NEAR(along(ratio, move), numeric, 0.02 * std::abs(numeric) + 1e-5);
}

TEST_F(ModifyTest, NoChangeIsTheSameBody) {
  const Points skin = person();
  BodyChange none;
  none.fat = fat_percentage(tape(), Sex::female, skin);
  const ChangedBody same = change_body(package(), tape(), space(), skin, none);
  EXPECT_TRUE(same.met);
  Points moved = same.points - skin;
  EXPECT_LT(moved.rowwise().norm().maxCoeff(), 1e-3);
}

TEST_F(ModifyTest, AttributesAreMetAndLengthsStay) {
  const Points skin = person();
  BodyChange change;
  change.fat = fat_percentage(tape(), Sex::female, skin) + 8;
  change.hip_waist = hip_waist_ratio(tape(), skin) - 0.05;
  const ChangedBody heavier = change_body(package(), tape(), space(), skin, change);
  EXPECT_TRUE(heavier.met);
  EXPECT_NEAR(fat_percentage(tape(), Sex::female, heavier.points), *change.fat, 0.02);
  EXPECT_NEAR(hip_waist_ratio(tape(), heavier.points), *change.hip_waist, 0.0003);
  for (const char* id : {"stature", "crotch_height", "arm_length_outseam"})
    EXPECT_NEAR(tape().take(at(id), heavier.points), tape().take(at(id), skin), 0.0005) << id;
  EXPECT_GT(tape().take(at("weight"), heavier.points), tape().take(at("weight"), skin) + 3);
}

TEST_F(ModifyTest, WhatIsThePersonsOwnStays) {
  const Points skin = person();
  BodyChange more, back;
  more.fat = fat_percentage(tape(), Sex::female, skin) + 6;
  const ChangedBody heavier = change_body(package(), tape(), space(), skin, more);
  back.fat = fat_percentage(tape(), Sex::female, skin);
  const ChangedBody again = change_body(package(), tape(), space(), heavier.points, back);
  EXPECT_LT((again.points - skin).rowwise().norm().mean(), 0.001);
}

TEST_F(ModifyTest, ExaggerationOfNothingIsTheMeanWithTheSameLengths) {
  const Points skin = person();
  BodyChange flat;
  flat.exaggeration = 0;
  const ChangedBody average = change_body(package(), tape(), space(), skin, flat);
  EXPECT_TRUE(average.met);
  BodyChange more;
  more.exaggeration = 1.5;
  const ChangedBody overdrawn = change_body(package(), tape(), space(), skin, more);
  const double own = tape().take(at("waist_girth"), skin),
               mean = tape().take(at("waist_girth"), space().mean);
  EXPECT_GT(std::abs(tape().take(at("waist_girth"), overdrawn.points) - mean),
            std::abs(own - mean));
}

}  // namespace
}  // namespace ecorche
