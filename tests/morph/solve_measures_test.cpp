#include "morph/shapes/solve_measures.h"
#include "anatomy/base_mesh/body_rig.h"
#include "morph/shapes/shape_space_cache.h"

#include <gtest/gtest.h>

#include <random>

#include <Eigen/Cholesky>

#include "anatomy/errors.h"
#include "anatomy/files/package_archive.h"
#include "anatomy/queries/signed_distance.h"
#include "morph/shapes/region_functions.h"
#include "morph/shapes/shape_age.h"
#include "tests/body_fixture.h"
#include "tests/morph/tape_check.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

// Measures of a person drawn from the survey's law.
class People {
 public:
  People(const Survey& survey, unsigned seed) : survey_(survey), random_(seed) {
    factor_ = (survey.correlation +
               1e-6 * Eigen::MatrixXd::Identity(survey.mean.size(), survey.mean.size()))
                  .llt()
                  .matrixL();
  }
  Eigen::VectorXd next() {
    Eigen::VectorXd u(survey_.mean.size());
    for (double& x : u) x = normal_(random_);
    return survey_.mean + survey_.sd.cwiseProduct(factor_ * u);
  }
  double of(const Eigen::VectorXd& person, int measure) const {
    for (std::size_t r = 0; r < survey_.measures.size(); ++r)
      if (survey_.measures[r] == measure) return person[r];
    throw std::invalid_argument("not in the survey");
  }

 private:
  const Survey& survey_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  Eigen::MatrixXd factor_;
};

const std::vector<std::string> kGiven{"neck_base_girth",    "chest_girth", "waist_girth",
                                      "hip_girth",          "stature",     "crotch_height",
                                      "arm_length_outseam", "weight"};

class SolveTest : public BodyFixture {
 protected:
  static const TapeMeasure& tape() {
    static const TapeMeasure once(package(),
                                  read_measure_table(package(), test_assets().tables / "body"));
    return once;
  }
  static const ShapeSpace& space(Sex sex) {
    static const ShapeSpace male = read_shape_space(package(), tape(), Sex::male),
                            female = read_shape_space(package(), tape(), Sex::female);
    return sex == Sex::male ? male : female;
  }
  static const Survey& survey(Sex sex) {
    static const Survey male =
                            read_survey(tape().table(), Sex::male, test_assets().tables / "body"),
                        female =
                            read_survey(tape().table(), Sex::female, test_assets().tables / "body");
    return sex == Sex::male ? male : female;
  }
  static std::vector<MeasureTarget> targets(const People& people, const Eigen::VectorXd& person,
                                            std::span<const std::string> names) {
    std::vector<MeasureTarget> out;
    for (const auto& name : names)
      out.push_back({tape().table().at(name), people.of(person, tape().table().at(name))});
    return out;
  }
  static int at(const char* id) { return tape().table().at(id); }
};

TEST_F(SolveTest, FeasibleSetsAreMetByMeasuringCodeOfItsOwn) {
  const TapeCheck check(package(), tape().table());
  double sum = 0;
  int count = 0;
  for (const Sex sex : {Sex::male, Sex::female}) {
    People people(survey(sex), 7);
    for (int set = 0; set < 20; ++set) {
      const auto asked = targets(people, people.next(), kGiven);
      const SolvedBody body = solve_measures(tape(), space(sex), asked);
      ASSERT_TRUE(body.met && body.conflicts.empty())
          << (body.conflicts.empty() ? "not reached" : describe(body.conflicts[0], tape(), asked));
      for (const MeasureTarget& target : asked) {
        const Measure& m = tape().measure(target.measure);
        const double found = check.take(m, body.points);
        EXPECT_NEAR(found, target.value, m.tolerance) << m.id;
        if (m.kind != MeasureKind::mass) sum += std::abs(found - target.value), ++count;
      }
    }
  }
  EXPECT_LT(sum / count, 0.001);
}

TEST_F(SolveTest, NothingAskedGivesTheSurveysMean) {
  for (const Sex sex : {Sex::male, Sex::female}) {
    const SolvedBody body = solve_measures(tape(), space(sex), {});
    EXPECT_TRUE(body.met);
    EXPECT_NEAR(tape().take(at("stature"), body.points), survey(sex).mean[0], 0.002);
    EXPECT_NEAR(body.points.col(1).minCoeff(), 0, 1e-12);
  }
}

TEST_F(SolveTest, EveryMeasureCanBeGivenAlone) {
  for (int k = 0; k < tape().count(); ++k) {
    MeasureGradient gradient;
    const double mean = tape().take(k, space(Sex::female).mean, &gradient);
    const std::vector<MeasureTarget> asked{
        {k, mean + 1.5 * space_gradient(space(Sex::female), gradient).norm()}};
    const SolvedBody body = solve_measures(tape(), space(Sex::female), asked);
    EXPECT_TRUE(body.met) << tape().measure(k).id << " " << body.achieved[0] << " for "
                          << asked[0].value;
  }
}

TEST_F(SolveTest, AllMeasuresAtOnceOfABodyOfTheSpaceAreMet) {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(space(Sex::male).basis.cols());
  for (Eigen::Index i = 0; i < z.size(); ++i) z[i] = std::sin(7.0 * double(i));
  const Points V = space_points(space(Sex::male), z);
  std::vector<MeasureTarget> asked;
  for (int k = 0; k < tape().count(); ++k) asked.push_back({k, tape().take(k, V)});
  const SolvedBody body = solve_measures(tape(), space(Sex::male), asked);
  EXPECT_TRUE(body.conflicts.empty());
  for (std::size_t i = 0; i < asked.size(); ++i)
    EXPECT_NEAR(body.achieved[i], asked[i].value, tape().measure(asked[i].measure).tolerance)
        << tape().measure(asked[i].measure).id;
}

// Bodies drawn from the space; the distance is that of the surfaces, once both stand in the same
// place.
TEST_F(SolveTest, BodiesComeBackFromTheirOwnMeasures) {
  constexpr int kBodies = 8;
  for (const Sex sex : {Sex::male, Sex::female}) {
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    double sum = 0;
    for (int i = 0; i < kBodies; ++i) {
      Eigen::VectorXd z(space(sex).basis.cols());
      for (double& x : z) x = normal(random);
      const Points own = space_points(space(sex), z);
      std::vector<MeasureTarget> asked;
      for (int k = 0; k < tape().count(); ++k) asked.push_back({k, tape().take(k, own)});
      SolveOptions any;
      any.allow_unusual = true;
      Points back = solve_measures(tape(), space(sex), asked, any).points;
      back.rowwise() += (own - back).colwise().mean();
      const SkinField surface(TriMesh{own, package().triangles});
      double distance = 0;
      for (Eigen::Index v = 0; v < back.rows(); ++v)
        distance += std::abs(surface.distance(back.row(v))) / double(back.rows());
      EXPECT_LT(distance, 0.002);
      sum += distance / kBodies;
    }
    EXPECT_LT(sum, 0.001) << (sex == Sex::male ? "male" : "female");
  }
}

TEST_F(SolveTest, AgeChangesTheBodyAndNotWhatWasAsked) {
  for (const Sex sex : {Sex::male, Sex::female}) {
    ShapeSpace young = space(sex), old = space(sex);
    move_to_age(package(), tape(), 25, young);
    move_to_age(package(), tape(), 80, old);
    People people(survey(sex), 13);
    const auto asked = targets(people, people.next(), kGiven);
    const SolvedBody a = solve_measures(tape(), young, asked),
                     b = solve_measures(tape(), old, asked);
    EXPECT_TRUE(a.met && b.met);
    EXPECT_GT((a.points - b.points).rowwise().norm().mean(), 0.003);
  }
}

// Shorter legs, all of the leg shorter: nowhere is the skin folded up.
TEST_F(SolveTest, ShortLegsHaveNoRidge) {
  const std::vector<MeasureTarget> asked{{at("stature"), 1.71},
                                         {at("crotch_height"), 0.68},
                                         {at("chest_girth"), 1.10},
                                         {at("waist_girth"), 1.02}};
  SolveOptions any;
  any.allow_unusual = true;
  const SolvedBody body = solve_measures(tape(), space(Sex::male), asked, any);
  ASSERT_TRUE(body.met);
  const auto parts = vertex_parts(package());
  const Points& mean = space(Sex::male).mean;
  double least = 1;
  for (Eigen::Index f = 0; f < package().triangles.rows(); ++f) {
    for (int e = 0; e < 3; ++e) {
      const int a = package().triangles(f, e), b = package().triangles(f, (e + 1) % 3);
      const double before = (mean.row(a) - mean.row(b)).norm();
      if (parts[a].part != BodyPart::thigh || before < 0.004) continue;
      least = std::min(least, (body.points.row(a) - body.points.row(b)).norm() / before);
    }
  }
  EXPECT_GT(least, 0.5);
}

TEST_F(SolveTest, LeftAndRightAreEqual) {
  People people(survey(Sex::female), 3);
  const SolvedBody body =
      solve_measures(tape(), space(Sex::female), targets(people, people.next(), kGiven));
  for (int v = 0; v < package().skin_size; ++v) {
    Vec3 other = body.points.row(package().mirror[v]);
    other.x() = -other.x();
    ASSERT_LT((body.points.row(v).transpose() - other).norm(), 2e-6) << v;
  }
}

TEST_F(SolveTest, ContradictionsAreNamed) {
  int flagged = 0, right = 0;
  constexpr int kSets = 200;
  for (const Sex sex : {Sex::male, Sex::female}) {
    People people(survey(sex), 11);
    std::mt19937 random(5);
    for (int set = 0; set < kSets / 2; ++set) {
      auto asked = targets(people, people.next(), kGiven);
      const std::size_t bad = random() % asked.size();
      const auto& s = survey(sex);
      for (std::size_t r = 0; r < s.measures.size(); ++r) {
        const double away = 4 * s.sd[r];
        if (s.measures[r] == asked[bad].measure)
          asked[bad].value = s.mean[r] + (asked[bad].value > s.mean[r] ? -away : away);
      }
      const std::vector<Conflict> conflicts = find_conflicts(space(sex), asked);
      if (conflicts.empty()) continue;
      ++flagged;
      const auto concerned = [bad](const Conflict& c) {
        return c.blamed == int(bad) ||
               std::find(c.others.begin(), c.others.end(), int(bad)) != c.others.end();
      };
      right += std::any_of(conflicts.begin(), conflicts.end(), concerned) ? 1 : 0;
      EXPECT_LT(conflicts[0].low, conflicts[0].high);
    }
  }
  EXPECT_EQ(flagged, kSets);
  EXPECT_EQ(right, kSets);
}

TEST_F(SolveTest, PeopleRaiseNoFalseAlarm) {
  int alarms = 0;
  constexpr int kSets = 1000;
  for (const Sex sex : {Sex::male, Sex::female}) {
    People people(survey(sex), 29);
    for (int set = 0; set < kSets / 2; ++set)
      alarms += find_conflicts(space(sex), targets(people, people.next(), kGiven)).empty() ? 0 : 1;
  }
  EXPECT_LT(alarms, kSets / 100);
}

TEST_F(SolveTest, ImpossibleWishesGiveTheNearestBody) {
  const std::vector<MeasureTarget> asked{
      {at("stature"), 1.70}, {at("crotch_height"), 1.05}, {at("waist_girth"), 0.80}};
  const SolvedBody body = solve_measures(tape(), space(Sex::female), asked);
  ASSERT_FALSE(body.conflicts.empty());
  EXPECT_FALSE(body.met);
  const Conflict& c = body.conflicts[0];
  EXPECT_TRUE((c.blamed == 0 && c.others == std::vector<int>{1}) ||
              (c.blamed == 1 && c.others == std::vector<int>{0}));
  for (std::size_t i = 0; i < asked.size(); ++i) {
    if (int(i) == c.blamed)
      EXPECT_NEAR(body.achieved[i], std::clamp(asked[i].value, c.low, c.high), 0.001);
    else
      EXPECT_NEAR(body.achieved[i], asked[i].value, 0.001);
  }
}

TEST_F(SolveTest, EditsEndWhereNewBodiesDo) {
  People people(survey(Sex::male), 31);
  auto asked = targets(people, people.next(), kGiven);
  const SolvedBody before = solve_measures(tape(), space(Sex::male), asked);
  asked[2].value += 0.01;
  const SolvedBody edited = solve_measures(tape(), space(Sex::male), asked, {}, &before.z),
                   anew = solve_measures(tape(), space(Sex::male), asked);
  EXPECT_TRUE(edited.met);
  EXPECT_LE(edited.rounds, anew.rounds);
  EXPECT_LT((edited.points - anew.points).rowwise().norm().maxCoeff(), 0.002);
}

TEST_F(SolveTest, SameWishTwiceIsAMistake) {
  const std::vector<MeasureTarget> asked{{at("stature"), 1.7}, {at("stature"), 1.8}};
  EXPECT_THROW(solve_measures(tape(), space(Sex::male), asked), UsageError);
}

// Largest distance from a similarity of the mean body's part, over the part's size.
double distortion(const Points& from, const Points& to, const std::vector<int>& part) {
  Eigen::Matrix3Xd a(3, Eigen::Index(part.size())), b(3, a.cols());
  for (Eigen::Index i = 0; i < a.cols(); ++i)
    a.col(i) = from.row(part[i]), b.col(i) = to.row(part[i]);
  const Eigen::Matrix4d X = Eigen::umeyama(a, b, true);
  const double size = (b.colwise() - b.rowwise().mean()).colwise().norm().mean();
  return ((X.topRows<3>() * a.colwise().homogeneous()) - b).colwise().norm().mean() / size;
}

TEST_F(SolveTest, HandsFeetAndFacesOnlyChangeAsWholes) {
  const auto parts = vertex_parts(package());
  std::vector<int> hand, foot, head;
  for (int v = 0; v < package().skin_size; ++v) {
    const VertexPart part = parts[v];
    if (part.part == BodyPart::hand && part.side == Side::left) hand.push_back(v);
    if (part.part == BodyPart::foot && part.side == Side::left) foot.push_back(v);
    if (part.part == BodyPart::head) head.push_back(v);
  }
  for (const Sex sex : {Sex::male, Sex::female}) {
    People people(survey(sex), 19);
    for (int set = 0; set < 6; ++set) {
      const SolvedBody body =
          solve_measures(tape(), space(sex), targets(people, people.next(), kGiven));
      EXPECT_LT(distortion(space(sex).mean, body.points, hand), 0.05);
      EXPECT_LT(distortion(space(sex).mean, body.points, foot), 0.05);
      EXPECT_LT(distortion(space(sex).mean, body.points, head), 0.05);
    }
  }
}

TEST(RegionFunctions, WindowAndSplineHaveTheirKnownValues) {
  EXPECT_DOUBLE_EQ(tukey_window(0.5, 0.3), 1);
  EXPECT_NEAR(tukey_window(0.075, 0.3), 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(tukey_window(0, 0.3), 0);
  EXPECT_NEAR(tukey_window(0.25, 1), 0.5, 1e-12);  // Hann
  const double bezier[] = {0, 1, 2, 5}, ones[] = {1, 1, 1, 1};
  EXPECT_NEAR(rational_spline(bezier, ones, 0.5), (0 + 3 * 1 + 3 * 2 + 5) / 8.0, 1e-12);
  const double r = std::sqrt(0.5), x[] = {1, 1, 0}, w[] = {1, r, 1};  // a quarter of a circle
  const double y[] = {0, 1, 1};
  EXPECT_NEAR(std::hypot(rational_spline(x, w, 0.3), rational_spline(y, w, 0.3)), 1, 1e-12);
}

}  // namespace
}  // namespace ecorche
