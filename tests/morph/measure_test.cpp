#include "morph/measures/tape_measure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "anatomy/errors.h"
#include "anatomy/files/package_archive.h"
#include "morph/shapes/body.h"
#include "tests/body_fixture.h"
#include "tests/morph/tape_check.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

class MeasureTest : public BodyFixture {
 protected:
  static const TapeMeasure& tape() {
    static const TapeMeasure once(package(),
                                  read_measure_table(package(), test_assets().tables / "body"));
    return once;
  }
  // Of the package's average stature; `weight` is its slider from thin to heavy.
  static Points body(Sex sex, double weight) {
    Macros macros;
    macros.male = sex == Sex::male ? 1 : 0;
    macros.weight = weight;
    Points out = shape_points(package(), macros).topRows(package().skin_size);
    out.col(1).array() -= out.col(1).minCoeff();
    return out;
  }
};

TEST_F(MeasureTest, AgreesWithMeasuringCodeOfItsOwn) {
  const TapeCheck check(package(), tape().table());
  for (const Points& V : {body(Sex::male, 0.3), body(Sex::male, 0.95), body(Sex::female, 0.2),
                          body(Sex::female, 0.9)}) {
    for (int k = 0; k < tape().count(); ++k) {
      const double expected = check.take(tape().measure(k), V);
      // A search that looks at every millimetre misses the best plane by a little.
      const double tolerance = tape().measure(k).search == Search::none ? 1e-6 : 2e-4;
      if (!std::isnan(expected)) {
        EXPECT_NEAR(tape().take(k, V), expected, tolerance) << tape().measure(k).id;
      }
    }
  }
}

TEST_F(MeasureTest, EveryMeasureLiesInsideWhatPeopleMeasure) {
  const Points V = body(Sex::male, 0.7);
  for (int k = 0; k < tape().count(); ++k) {
    const double value = tape().take(k, V);
    EXPECT_GT(value, 0.03) << tape().measure(k).id;
    EXPECT_LT(value, tape().measure(k).kind == MeasureKind::mass ? 79 : 2.0)
        << tape().measure(k).id;
  }
}

TEST_F(MeasureTest, ScaledBodiesHaveScaledMeasures) {
  const Points V = body(Sex::female, 0.6);
  for (int k = 0; k < tape().count(); ++k) {
    if (tape().measure(k).search != Search::none)
      continue;  // the reach of a search does not grow with the body
    const double factor = tape().measure(k).kind == MeasureKind::mass ? 1.331 : 1.1;
    EXPECT_NEAR(tape().take(k, 1.1 * V), factor * tape().take(k, V), 1e-9) << tape().measure(k).id;
  }
}

// Along displacements that are the same on both sides, as all of the shape space are.
TEST_F(MeasureTest, DerivativesAreThoseOfDifferences) {
  const Points V = body(Sex::male, 0.75);
  Points D = V;
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    const double x = std::abs(V(v, 0)), y = V(v, 1), z = V(v, 2);
    D(v, 0) = (V(v, 0) < 0 ? -1 : 1) * x * std::cos(3 * y);
    D(v, 1) = 0.3 * y + 0.1 * std::sin(4 * x);
    D(v, 2) = 0.3 * std::sin(2 * y + 5 * z);
  }
  MeasureGradient gradient;
  for (int k = 0; k < tape().count(); ++k) {
    tape().take(k, V, &gradient);
    double slope = 0;
    for (const auto& [vertex, g] : gradient) slope += g.dot(D.row(vertex).transpose());
    constexpr double kStep = 1e-5;
    const double difference =
        (tape().take(k, V + kStep * D) - tape().take(k, V - kStep * D)) / (2 * kStep);
    EXPECT_NEAR(slope, difference, 0.02 * std::abs(difference) + 0.01) << tape().measure(k).id;
  }
}

TEST_F(MeasureTest, TracesAreAsLongAsTheTape) {
  const Points V = body(Sex::female, 0.4);
  for (int k = 0; k < tape().count(); ++k) {
    const Measure& m = tape().measure(k);
    if (m.kind != MeasureKind::girth && m.kind != MeasureKind::path &&
        m.kind != MeasureKind::distance && m.kind != MeasureKind::height)
      continue;
    if (m.arms_off) continue;  // drawn closed where the arm was left out
    TapeTrace trace;
    const double value = tape().take(k, V, nullptr, &trace);
    double length = 0;
    for (const auto& line : trace)
      for (std::size_t i = 0; i + 1 < line.size(); ++i) length += (line[i + 1] - line[i]).norm();
    EXPECT_NEAR(length, value, 1e-9) << m.id;
  }
}

// Every measure can be written in every unit, and a bare number only where it can be nothing but
// metres.
TEST_F(MeasureTest, ReadsEveryMeasureInEveryUnit) {
  for (int k = 0; k < tape().count(); ++k) {
    const Measure& m = tape().measure(k);
    if (m.kind == MeasureKind::mass || m.kind == MeasureKind::ahead) continue;
    const double usual = tape().take(k, package().points);
    const auto read = [&](double value, const char* unit) {
      return tape().parse(k, fmt::format("{:.9f}{}", value, unit), m.id);
    };
    EXPECT_NEAR(read(100 * usual, "cm"), usual, 1e-6) << m.id;
    EXPECT_NEAR(read(usual / 0.0254, "in"), usual, 1e-6) << m.id;
    EXPECT_NEAR(read(usual, ""), usual, 1e-6) << m.id;
    for (const double factor : {100.0, 1000.0, 1 / 0.0254})
      EXPECT_THROW(read(factor * usual, ""), UsageError) << m.id << " " << factor;
    for (const char* bad : {"", "cm", "-3cm", "nan", "92furlongs", "1e400", "70kg"})
      EXPECT_THROW(tape().parse(k, bad, m.id), UsageError) << m.id << " " << bad;
  }
  const int weight = tape().table().at("weight");
  EXPECT_DOUBLE_EQ(tape().parse(weight, "70kg", "weight"), 70);
}

}  // namespace
}  // namespace ecorche
