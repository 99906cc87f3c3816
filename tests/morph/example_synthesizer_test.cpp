#include "morph/shapes/example_synthesizer.h"

#include <cmath>

#include "anatomy/files/package_archive.h"
#include "tests/body_fixture.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

// Points spread evenly over a square, as by Halton.
Eigen::MatrixXd spread(int count) {
  Eigen::MatrixXd X(count, 2);
  for (int i = 0; i < count; ++i)
    X.row(i) << std::fmod(0.618034 * (i + 1), 1.0) * 4 - 2,
        std::fmod(0.754878 * (i + 1), 1.0) * 4 - 2;
  return X;
}

TEST(RadialNetwork, LeftOutIsWhatAFitWithoutTheExampleSays) {
  const Eigen::MatrixXd X = spread(20);
  const Eigen::VectorXd y = (X.col(0).array().sin() + X.col(1).array().square()).matrix();
  RadialOptions linear;
  linear.gaussians = 0;
  linear.ridge = 1e-12;
  Eigen::VectorXd left_out;
  learn_network(X, y, linear, &left_out);
  for (Eigen::Index out = 0; out < X.rows(); out += 3) {
    Eigen::MatrixXd others(X.rows() - 1, 2);
    Eigen::VectorXd of_others(X.rows() - 1);
    for (Eigen::Index i = 0, k = 0; i < X.rows(); ++i)
      if (i != out) others.row(k) = X.row(i), of_others[k++] = y[i];
    EXPECT_NEAR(evaluate(learn_network(others, of_others, linear), X.row(out).transpose()),
                left_out[out], 1e-6);
  }
}

TEST(RadialNetwork, GaussiansFollowWhatNoPlaneDoes) {
  const Eigen::MatrixXd X = spread(60);
  const auto f = [](double a, double b) { return std::exp(-a * a) + 0.3 * std::sin(2 * b) + a; };
  Eigen::VectorXd y(60);
  for (Eigen::Index i = 0; i < 60; ++i) y[i] = f(X(i, 0), X(i, 1));
  RadialOptions none;
  none.gaussians = 0;
  const RadialNetwork plane = learn_network(X, y, none), network = learn_network(X, y);
  double plane_miss = 0, miss = 0;
  for (double a = -1.5; a <= 1.5; a += 0.25)
    for (double b = -1.5; b <= 1.5; b += 0.25) {
      plane_miss += std::abs(evaluate(plane, Eigen::Vector2d(a, b)) - f(a, b));
      miss += std::abs(evaluate(network, Eigen::Vector2d(a, b)) - f(a, b));
    }
  EXPECT_LT(miss, 0.4 * plane_miss);
  EXPECT_EQ(evaluate(network, Eigen::Vector2d(0.3, 0.4)),
            evaluate(learn_network(X, y), Eigen::Vector2d(0.3, 0.4)));
}

class SynthesizerTest : public BodyFixture {};

TEST_F(SynthesizerTest, ExamplesComeBackAndLeftOutOnesNearly) {
  const TapeMeasure tape(package(), read_measure_table(package(), test_assets().tables / "body"));
  const ExampleSynthesizer learned = learn_synthesizer(package(), tape, Sex::female, 60);
  for (const LeftOut& row : cross_validate(package(), tape, Sex::female, learned)) {
    EXPECT_GT(row.correlation, 0.9) << row.measure;
    EXPECT_LT(row.mean_difference, 0.04) << row.measure;
  }
  // The mean of the measures gives a body that has about these.
  std::array<double, 8> mean{};
  for (std::size_t k = 0; k < mean.size(); ++k) mean[k] = learned.input_mean[k];
  const Points body = synthesize(learned, mean);
  EXPECT_NEAR(body.col(1).minCoeff(), 0, 1e-12);
  for (std::size_t k = 0; k < mean.size(); ++k)
    EXPECT_NEAR(tape.take(tape.table().at(kPaperMeasures[k]), body), mean[k], 0.05)
        << kPaperMeasures[k];
}

}  // namespace
}  // namespace ecorche
