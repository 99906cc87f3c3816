#include "morph/shapes/body_statistics.h"

#include <gtest/gtest.h>

#include <random>

#include "morph/shapes/shape_space_cache.h"
#include "morph/shapes/statistic_people.h"
#include "tests/body_fixture.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

// People of few vertices with known ways to differ, and attributes that follow them.
std::vector<StatisticPerson> known_people(int count, std::mt19937& random) {
  constexpr int kVertices = 40;
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    Points out(kVertices, 3);
    for (Eigen::Index i = 0; i < out.size(); ++i) out.data()[i] = normal(random);
    out.rowwise() -= out.colwise().mean().eval();
    out.row(0).setZero();  // the lowest point stays where it is
    return Points(out / out.norm());
  };
  const Points first = direction(), second = direction();
  Points mean = direction();
  mean.row(0) << 0, -5, 0;
  std::vector<StatisticPerson> out;
  for (int i = 0; i < count; ++i) {
    const double a = normal(random), b = normal(random);
    StatisticPerson person;
    person.skin = mean + 0.3 * a * first + 0.1 * b * second;
    person.stature = 1.7 + 0.1 * a;
    person.mass = 70 + 10 * a + 5 * b;
    person.age = 50 + 12 * normal(random);
    out.push_back(person);
  }
  return out;
}

TEST(BodyStatisticsLaws, FindTheWaysInWhichPeopleDiffer) {
  std::mt19937 random(3);
  const std::vector<StatisticPerson> people = known_people(400, random);
  const BodyStatistics statistics = learn_statistics(Sex::male, people);
  EXPECT_NEAR(statistics.deviation[0], 0.3, 0.03);
  EXPECT_NEAR(statistics.deviation[1], 0.1, 0.01);
  EXPECT_NEAR(statistics.explained[1], 1, 1e-3);
  const Eigen::MatrixXf gram =
      statistics.components.leftCols(2).transpose() * statistics.components.leftCols(2);
  EXPECT_LT((gram - Eigen::MatrixXf::Identity(2, 2)).cwiseAbs().maxCoeff(), 1e-4);
  // Attributes that the skin tells, and one that it does not.
  EXPECT_LT(statistics.attribute_error[2], 0.005);
  EXPECT_LT(statistics.attribute_error[1], 0.5);
  EXPECT_GT(statistics.attribute_error[0], 0.9 * statistics.attribute_deviation[0]);
}

TEST(BodyStatisticsLaws, KnowChiSquare) {
  EXPECT_NEAR(chi_square_share(9.342, 10), 0.5, 1e-4);
  EXPECT_NEAR(chi_square_share(18.307, 10), 0.95, 1e-4);
  EXPECT_NEAR(chi_square_share(29.588, 10), 0.999, 1e-5);
  EXPECT_EQ(chi_square_share(0, 10), 0);
}

class BodyStatisticsTest : public BodyFixture {
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
  static const BodyStatistics& women() {
    static const BodyStatistics once = read_statistics(package(), tape(), space());
    return once;
  }
  static const std::vector<StatisticPerson>& others() {
    static const std::vector<StatisticPerson> once =
        draw_statistic_people(package(), tape(), space(), 30, 77);
    return once;
  }
};

Points placed_alike(Points skin) {
  const Eigen::RowVector3d middle = skin.colwise().mean();
  skin.rowwise() -= Eigen::RowVector3d(middle.x(), skin.col(1).minCoeff(), middle.z());
  return skin;
}

TEST_F(BodyStatisticsTest, ComponentsGiveOthersBack) {
  EXPECT_GT(women().explained[9], 0.92);
  EXPECT_GT(women().explained[49], 0.99);
  // People who are not among those of the statistics: 50 components to 1.5 mm, ten to 10.
  double all = 0, ten = 0;
  for (const StatisticPerson& person : others()) {
    const Points back = skin_of_scores(women(), scores_of(women(), person.skin));
    all += (placed_alike(person.skin) - placed_alike(back)).rowwise().norm().mean();
    ten += describe_body(women(), person.skin).left_mean;
  }
  EXPECT_LT(all / double(others().size()), 0.0015);
  EXPECT_LT(ten / double(others().size()), 0.010);
}

TEST_F(BodyStatisticsTest, DescribesPeople) {
  double distance2 = 0, age2 = 0;
  for (const StatisticPerson& person : others()) {
    const BodyDescription d = describe_body(women(), person.skin);
    distance2 += d.distance * d.distance;
    age2 += std::pow(d.age - person.age, 2);
    EXPECT_NEAR(d.mass, person.mass, 4 * d.mass_error + 1);
    EXPECT_NEAR(d.stature, person.stature, 0.01);
  }
  const double n = double(others().size());
  EXPECT_NEAR(distance2 / n, BodyStatistics::kScores, 4);
  EXPECT_LT(std::sqrt(age2 / n), 15);
  const BodyDescription mean = describe_body(women(), women().mean);
  EXPECT_LT(mean.distance, 0.02);
  EXPECT_LT(mean.percentile, 1e-6);
  const BodyDescription giant = describe_body(women(), 1.3 * women().mean);
  EXPECT_GT(giant.percentile, 99.9);
}

TEST_F(BodyStatisticsTest, TheOldStoopAndStoutenAtOneStatureAndMass) {
  const double mass = women().attribute_mean[1], height = women().attribute_mean[2];
  const Points young = skin_of_scores(women(), scores_of_attributes(women(), 30, mass, height)),
               old = skin_of_scores(women(), scores_of_attributes(women(), 80, mass, height));
  const auto change = [&](const char* id) {
    const int k = tape().table().at(id);
    return tape().take(k, old) - tape().take(k, young);
  };
  EXPECT_NEAR(change("stature"), 0, 0.01);
  EXPECT_NEAR(change("weight"), 0, 2);
  EXPECT_GT(change("waist_girth"), 0.005);
  EXPECT_LT(change("toes_before_neck"), -0.01);    // the neck comes forward
  EXPECT_LT(change("waist_front_length"), -0.01);  // the trunk bends
  EXPECT_LT(change("chest_height"), -0.005);
  EXPECT_LT(change("shoulder_girth"), -0.02);
}

TEST_F(BodyStatisticsTest, ItemsAreMetInClosedFormAndBySolver) {
  const auto items = axis_items(package(), tape());
  std::vector<ItemValue> wanted;
  for (const AxisItem& item : items) wanted.push_back({item, take_item(item, others()[4].skin)});
  const Points closed = skin_of_scores(women(), scores_of_items(women(), wanted));
  SolveOptions options;
  for (const ItemValue& item : wanted) options.also.push_back(item_aim(item.item, item.value));
  const SolvedBody solved = solve_measures(tape(), space(), {}, options);
  EXPECT_TRUE(solved.met);
  for (const ItemValue& item : wanted) {
    // The floor moves a little with the shape of the feet.
    EXPECT_NEAR(take_item(item.item, closed), item.value, 0.004) << item.item.name;
    EXPECT_NEAR(take_item(item.item, solved.points), item.value, 0.0003) << item.item.name;
  }
}

TEST_F(BodyStatisticsTest, ScoreAimsHaveTheirGradient) {
  const Points& skin = others()[3].skin;
  const Aim aim = score_aim(women(), 1, 0);
  EXPECT_NEAR(aim.value(skin, nullptr), scores_of(women(), skin)[1], 1e-3);
  MeasureGradient gradient;
  aim.value(skin, &gradient);
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  Points by(skin.rows(), 3);
  for (Eigen::Index i = 0; i < by.size(); ++i) by.data()[i] = normal(random);
  // Soles alike: which point is the lowest stays undecided on a symmetric body.
  for (Eigen::Index i = 0; i < by.rows(); ++i)
    if (skin(i, 1) < 0.01) by(i, 1) = 0.3;
  double slope = 0;
  for (const auto& [vertex, g] : gradient) slope += g.dot(by.row(vertex));
  constexpr double kStep = 1e-6;
  const double difference =
      (aim.value(skin + kStep * by, nullptr) - aim.value(skin - kStep * by, nullptr)) / (2 * kStep);
  EXPECT_NEAR(slope, difference, 1e-3 * std::abs(difference) + 1e-3);
}

}  // namespace
}  // namespace ecorche
