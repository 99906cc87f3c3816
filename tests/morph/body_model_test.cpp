#include "morph/shapes/body_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "anatomy/files/package_archive.h"
#include "morph/shapes/modify_body.h"
#include "morph/shapes/muscularity.h"
#include "morph/shapes/shape_age.h"
#include "morph/shapes/standard_bodies.h"
#include "morph/shapes/tell_sex.h"
#include "tests/body_fixture.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

constexpr Sex kSexes[] = {Sex::male, Sex::female};

class BodyModelTest : public BodyFixture {
 protected:
  static const BodyModel& model() {
    static const BodyModel once(package());
    return once;
  }
  static int at(const char* id) { return model().tape().table().at(id); }
  static double take(const char* id, const Body& body) {
    return model().tape().take(at(id), body.skin.V);
  }
  static Survey survey(Sex sex) {
    return read_survey(model().tape().table(), sex, test_assets().tables / "body");
  }
  static double apart(const Body& a, const Body& b) {
    return (a.skin.V - b.skin.V).rowwise().norm().maxCoeff();
  }
  static std::string refusal(const BodySpec& spec) {
    try {
      make_body(model(), spec);
    } catch (const UnfitError& e) {
      return e.what();
    }
    return "";
  }
  // Another each time the test is changed; the same in each run.
  std::mt19937 random{20260};
  double between(double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  }
};

TEST_F(BodyModelTest, OneWishIsOnePersonHoweverItIsSpelt) {
  for (int i = 0; i < 6; ++i) {
    const Sex sex = kSexes[i % 2];
    const double height = sex == Sex::male ? between(1.6, 1.95) : between(1.5, 1.82),
                 mass = between(19, 31) * height * height;
    const std::optional<double> age =
        i < 2 ? std::nullopt : std::optional(std::floor(between(18, 80)));
    const Body a = make_body(model(), {.sex = sex, .age = age, .height = height, .mass = mass});
    const Body b = make_body(
        model(),
        {.sex = sex, .age = age, .measures = {{at("weight"), mass}, {at("stature"), height}}});
    EXPECT_LT(apart(a, b), 1e-4) << height << " m " << mass << " kg";
    EXPECT_NEAR(take("stature", a), height, 0.0005);
    EXPECT_NEAR(take("weight", a), mass, 0.05);
  }
}

TEST_F(BodyModelTest, MeasuresTellTheSex) {
  constexpr int kPeople = 60;
  const SexLaws laws = make_sex_laws(model());
  std::normal_distribution<> usual;
  for (const Sex sex : kSexes) {
    const ShapeSpace& space = model().adults(sex);
    Eigen::VectorXd z(space.basis.cols());
    int told = 0;
    for (int i = 0; i < kPeople; ++i) {
      for (double& coefficient : z) coefficient = usual(random);
      Points skin = space_points(space, z);
      skin.col(1).array() -= skin.col(1).minCoeff();
      told += told_sex(laws, skin) == sex;
    }
    EXPECT_GE(told, 0.97 * kPeople);
    // The package's own average build, of which no survey knows.
    EXPECT_EQ(told_sex(laws, shape_body(package(), {.sex = sex}).body.skin.V), sex);
    for (const double mass_index : {18.0, 25.0, 33.0, 40.0}) {
      const Body body =
          most_probable_body(model(), {.sex = sex, .height = 1.7, .mass = mass_index * 1.7 * 1.7})
              .body;
      EXPECT_EQ(told_sex(laws, body.skin.V), sex) << mass_index;
    }
  }
}

TEST_F(BodyModelTest, TheAverageIsTheSurveys) {
  for (const Sex sex : kSexes) {
    const Survey people = survey(sex);
    const Body average = make_body(model(), {.sex = sex});
    for (Eigen::Index r = 0; r < people.mean.size(); ++r) {
      const int k = people.measures[r];
      EXPECT_NEAR(model().tape().take(k, average.skin.V), people.mean[r], 0.5 * people.sd[r])
          << model().tape().measure(k).id;
    }
    EXPECT_NEAR(average.mass, people.mean[people.mean.size() - 1], 1)
        << "the survey's last field is the mass";
  }
}

TEST_F(BodyModelTest, AllOfTheBodyMassIndexCanBeHadByStatureAndMass) {
  for (int i = 0; i < 10; ++i) {
    const Sex sex = kSexes[i % 2];
    const double height = sex == Sex::male ? between(1.6, 1.93) : between(1.5, 1.8),
                 index = 17 + 28 * (i / 2) / 4.0;
    const Body body =
        make_body(model(), {.sex = sex, .height = height, .mass = index * height * height});
    EXPECT_NEAR(take("weight", body) / (height * height), index, 0.05);
  }
  EXPECT_NO_THROW(make_body(model(), {.sex = Sex::female, .height = 1.62, .mass = 95}));
}

TEST_F(BodyModelTest, WhatPeopleDoNotHaveIsRefusedWithWhatIsPossible) {
  EXPECT_NE(refusal({.sex = Sex::male, .height = 1.75, .mass = 250}).find("is possible"),
            std::string::npos);
  EXPECT_NE(refusal({.sex = Sex::male, .height = 1.75, .mass = 30}).find("is possible"),
            std::string::npos);
  EXPECT_NE(refusal({.sex = Sex::female, .height = 2.9}).find("is possible"), std::string::npos);
  EXPECT_NE(refusal({.sex = Sex::female, .height = std::numeric_limits<double>::quiet_NaN()})
                .find("stature"),
            std::string::npos);
  EXPECT_NE(refusal({.sex = Sex::female, .mass = -4.0}).find("weight"), std::string::npos);
  EXPECT_NE(refusal({.sex = Sex::female, .age = 120}).find("from 1 to 90"), std::string::npos);
  EXPECT_NE(refusal({.sex = Sex::female, .muscle = 1.5}).find("from 0 to 1"), std::string::npos);
  SolveOptions any;
  any.allow_unusual = true;
  for (const char* id : {"waist_girth", "neck_girth", "stature"})
    EXPECT_THROW(most_probable_body(model(), {.measures = {{at(id), 80}}}, any), UnfitError) << id;
}

TEST_F(BodyModelTest, AgesHaveTheStatureAndMassOfPublishedMeans) {
  for (const Sex sex : kSexes) {
    for (const double age : {1.0, 2.5, 5.0, 8.0, 12.0, 14.5, 17.0, 21.0, 45.0, 70.0, 85.0}) {
      const Growth growth = growth_at(test_assets().tables, sex, age);
      const Body body = make_body(model(), {.sex = sex, .age = age});
      EXPECT_NEAR(take("stature", body), growth.stature, 0.002) << age;
      EXPECT_NEAR(body.mass, growth.mass, 0.5) << age;
      EXPECT_NEAR(take("head_girth", body), growth.head_girth, 0.005) << age;
    }
  }
  EXPECT_NEAR(growth_at(test_assets().tables, Sex::male, 10).stature, 1.386,
              0.001);  // CDC 2000, median
  EXPECT_NEAR(growth_at(test_assets().tables, Sex::female, 7.5).mass, 24.2, 0.1);
  EXPECT_NEAR(growth_at(test_assets().tables, Sex::female, 80).mass, 70, 3);
}

// From month to month nothing leaps, least of all where growing ends.
TEST_F(BodyModelTest, AgesPassIntoOneAnotherWithoutAStep) {
  for (const Sex sex : kSexes) {
    for (const double age : {2.95, 9.95, 12.95, 16.95, 17.95, 24.95, 49.95}) {
      const Body a = make_body(model(), {.sex = sex, .age = age}),
                 b = make_body(model(), {.sex = sex, .age = age + 0.1});
      const double grown = std::abs(growth_at(test_assets().tables, sex, age + 0.1).stature -
                                    growth_at(test_assets().tables, sex, age).stature);
      EXPECT_LT(apart(a, b), grown + 0.0045) << age;
    }
    const double age = between(17.5, 17.99);
    const Body a = make_body(model(), {.sex = sex, .age = age, .height = 1.66, .mass = 61}),
               b = make_body(model(), {.sex = sex, .age = 18, .height = 1.66, .mass = 61});
    EXPECT_LT(apart(a, b), 0.004) << age;
  }
}

TEST_F(BodyModelTest, ChildrenAreNoSmallAdults) {
  for (const Sex sex : kSexes) {
    const Body child = make_body(model(), {.sex = sex, .age = 5}),
               adult = make_body(model(), {.sex = sex});
    const double size = take("stature", child) / take("stature", adult);
    EXPECT_GT(take("head_girth", child) / take("head_girth", adult), 1.3 * size);
    EXPECT_LT(take("crotch_height", child) / take("crotch_height", adult), 0.97 * size);
    EXPECT_LT(take("biacromial_breadth", child) / take("biacromial_breadth", adult), 1.05 * size);
    // Of the same stature and mass, by age alone.
    const Body younger = make_body(model(), {.sex = sex, .age = 9, .height = 1.4, .mass = 33}),
               older = make_body(model(), {.sex = sex, .age = 14, .height = 1.4, .mass = 33});
    EXPECT_GT(apart(younger, older), 0.005);
  }
}

// More muscle at the same stature and mass: larger limbs and chest, a smaller waist, and nothing
// that people do not have.
TEST_F(BodyModelTest, MuscleTakesThePlaceOfFat) {
  for (const Sex sex : kSexes) {
    const double height = sex == Sex::male ? between(1.68, 1.85) : between(1.55, 1.72),
                 mass = between(22, 29) * height * height;
    const std::vector<MeasureTarget> given{{at("stature"), height}, {at("weight"), mass}};
    const Survey people = survey(sex);
    std::vector<Body> bodies;
    for (const double muscle : {0.0, 0.2, 0.5, 0.8, 0.95, 1.0}) {
      bodies.push_back(
          make_body(model(), {.sex = sex, .height = height, .mass = mass, .muscle = muscle}));
      const Body& body = bodies.back();
      EXPECT_NEAR(body.mass, mass, 0.05);
      for (int k : people.measures) {
        if (k == at("stature") || k == at("weight")) continue;
        const double away =
            deviation(model().adults(sex), given, {k, model().tape().take(k, body.skin.V)});
        EXPECT_LT(std::abs(away), 3) << muscle << ' ' << model().tape().measure(k).id;
      }
    }
    EXPECT_LT(apart(bodies[2], make_body(model(), {.sex = sex, .height = height, .mass = mass})),
              1e-6)
        << "one half is what is not asked";
    for (std::size_t i = 1; i < bodies.size(); ++i) {
      for (const char* id :
           {"upper_arm_girth_relaxed", "forearm_girth", "thigh_girth", "calf_girth", "chest_girth"})
        EXPECT_GT(take(id, bodies[i]), take(id, bodies[i - 1])) << id << ' ' << i;
      EXPECT_LT(take("waist_girth", bodies[i]), take("waist_girth", bodies[i - 1])) << i;
      EXPECT_LT(fat_percentage(model().tape(), sex, bodies[i].skin.V),
                fat_percentage(model().tape(), sex, bodies[i - 1].skin.V))
          << i;
    }
  }
  EXPECT_NEAR(muscle_deviations(0.8), 0.8416, 1e-3);
  EXPECT_EQ(muscle_deviations(0.5), 0);
}

TEST_F(BodyModelTest, StandardBodiesCanBeMade) {
  std::set<std::string> names;
  auto specs = standard_bodies();
  EXPECT_GE(specs.size(), 10u);
  specs.push_back(athlete());
  for (const auto& spec : specs) {
    const Body body = make_body(model(), spec);
    EXPECT_TRUE(body.skin.V.allFinite());
    EXPECT_TRUE(names.insert(spec.name).second) << spec.name;
    EXPECT_NEAR(body.mass, spec.mass.value_or(body.mass), 0.1) << spec.name;
    EXPECT_NEAR(take("stature", body), spec.height.value_or(take("stature", body)), 0.001)
        << spec.name;
  }
}

}  // namespace
}  // namespace ecorche
