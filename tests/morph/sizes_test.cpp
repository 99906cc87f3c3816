#include "morph/shapes/sizes.h"

#include "anatomy/files/package_archive.h"
#include "morph/shapes/shape_space_cache.h"
#include "tests/body_fixture.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

// A standing figure of boxes: legs apart, arms apart below `armpit`, a trunk that is narrow at the
// waist.
void add_box(TriMesh& mesh, const Vec3& low, const Vec3& high) {
  const int base = mesh.V.rows();
  mesh.V.conservativeResize(base + 8, 3);
  for (int k = 0; k < 8; ++k)
    mesh.V.row(base + k) << (k & 1 ? high : low).x(), (k & 2 ? high : low).y(),
        (k & 4 ? high : low).z();
  static constexpr int faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                       {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                       {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const auto first = mesh.F.rows();
  mesh.F.conservativeResize(first + 12, 3);
  for (int f = 0; f < 12; ++f)
    mesh.F.row(first + f) << base + faces[f][0], base + faces[f][1], base + faces[f][2];
}

TEST(FeaturePoints, OfAFigureOfBoxesAreWhereItsBoxesMeet) {
  TriMesh figure;
  add_box(figure, Vec3(-0.20, 0.00, -0.1), Vec3(-0.05, 0.80, 0.1));  // legs
  add_box(figure, Vec3(0.05, 0.00, -0.1), Vec3(0.20, 0.80, 0.1));
  add_box(figure, Vec3(-0.20, 0.80, -0.1), Vec3(0.20, 1.00, 0.1));  // hip
  add_box(figure, Vec3(-0.15, 1.00, -0.1), Vec3(0.15, 1.20, 0.1));  // waist
  add_box(figure, Vec3(-0.22, 1.20, -0.1), Vec3(0.22, 1.35, 0.1));  // chest
  add_box(figure, Vec3(-0.40, 1.35, -0.1), Vec3(0.40, 1.50, 0.1));  // shoulders, arms and all
  add_box(figure, Vec3(-0.40, 0.90, -0.1), Vec3(-0.30, 1.35, 0.1));
  add_box(figure, Vec3(0.30, 0.90, -0.1), Vec3(0.40, 1.35, 0.1));
  add_box(figure, Vec3(-0.10, 1.50, -0.1), Vec3(0.10, 1.75, 0.1));
  const BodyFeatures found = find_features(figure);
  EXPECT_NEAR(found.stature, 1.75, 1e-12);
  EXPECT_NEAR(found.crotch_height, 0.80, 0.003);
  EXPECT_NEAR(found.armpit_left.y(), 1.35, 0.003);
  EXPECT_NEAR(found.armpit_left.x(), 0.22, 1e-9);
  EXPECT_NEAR(found.armpit_right.x(), -0.22, 1e-9);
  EXPECT_NEAR(found.bust.girth, 2 * (0.44 + 0.2), 1e-9);
  EXPECT_NEAR(found.waist.girth, 2 * (0.30 + 0.2), 1e-9);
  EXPECT_NEAR(found.hip.girth, 2 * (0.40 + 0.2), 1e-9);
}

TEST(FeaturePoints, ArmsAgainstTheTrunkAreRefused) {
  TriMesh post;
  add_box(post, Vec3(-0.2, 0, -0.1), Vec3(0.2, 1.75, 0.1));
  EXPECT_THROW(find_features(post), UnfitError);
}

class SizesTest : public BodyFixture {};

TEST_F(SizesTest, EverySizeHasItsMeasuresAndIsNearestToItself) {
  const auto folder = test_assets().tables / "body";
  const TapeMeasure tape(package(), read_measure_table(package(), folder));
  const std::vector<StandardSize> sizes = read_sizes(folder);
  EXPECT_EQ(sizes.size(), 14u);
  for (const Sex sex : {Sex::male, Sex::female}) {
    const ShapeSpace space = read_shape_space(package(), tape, sex);
    std::vector<std::vector<SizeFigure>> figures;
    std::vector<std::string> names;
    for (const StandardSize& size : sizes) {
      if (size.sex != sex) continue;
      const std::vector<MeasureTarget> targets = size_targets(size, tape.table());
      const SolvedBody body = solve_measures(tape, space, targets);
      EXPECT_TRUE(body.conflicts.empty()) << size.name;
      for (std::size_t i = 0; i < targets.size(); ++i) {
        const Measure& m = tape.measure(targets[i].measure);
        EXPECT_NEAR(body.achieved[i], targets[i].value, 0.2 * m.tolerance)
            << size.name << ' ' << m.id;
      }
      figures.push_back(size_figures(tape, package(), body.points));
      names.push_back(size.name);
    }
    for (std::size_t i = 0; i < figures.size(); ++i) {
      EXPECT_EQ(size_distance(figures[i], figures[i]), 0);
      // Larger and larger: the distance grows with every letter between.
      for (std::size_t j = i + 1; j + 1 < figures.size(); ++j)
        EXPECT_LT(size_distance(figures[i], figures[j]), size_distance(figures[i], figures[j + 1]))
            << names[i] << " " << names[j];
    }
  }
}

TEST_F(SizesTest, FeaturePointsLieWhereTheLandmarksAre) {
  const auto folder = test_assets().tables / "body";
  const TapeMeasure tape(package(), read_measure_table(package(), folder));
  const ShapeSpace space = read_shape_space(package(), tape, Sex::female);
  const SolvedBody body = solve_measures(tape, space, {});
  const BodyFeatures found = find_features({body.points, package().triangles});
  const auto measured = [&](const char* id) { return tape.take(tape.table().at(id), body.points); };
  EXPECT_NEAR(found.crotch_height, measured("crotch_height"), 0.01);
  EXPECT_NEAR(found.armpit_left.y(), measured("axilla_height"), 0.04);
  EXPECT_GE(found.bust.girth, measured("chest_girth") - 0.001);
  EXPECT_LE(found.waist.girth, measured("waist_girth") + 0.001);
  EXPECT_GE(found.hip.girth, measured("hip_girth") - 0.001);
  EXPECT_NEAR(found.armpit_left.x(), -found.armpit_right.x(), 1e-4);
}

TEST_F(SizesTest, UnknownSizesAreNamed) {
  EXPECT_THROW(find_size(read_sizes(test_assets().tables / "body"), Sex::male, "XXXL"), UsageError);
  EXPECT_EQ(find_size(read_sizes(test_assets().tables / "body"), Sex::male, "xl").name, "XL");
}

}  // namespace
}  // namespace ecorche
