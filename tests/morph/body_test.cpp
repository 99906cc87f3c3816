#include "morph/shapes/body.h"

#include <gtest/gtest.h>

#include <limits>

#include "anatomy/errors.h"
#include "tests/body_fixture.h"

namespace ecorche {
namespace {

class BodyTest : public BodyFixture {};

double independent_volume(
    const TriMesh& mesh) {  // by z-columns: sum of signed prisms below each triangle
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    const double area =
        0.5 * ((b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y()));
    sum += area * (a.z() + b.z() + c.z()) / 3;
  }
  return sum;
}

TEST_F(BodyTest, AveragesHaveTheKnownSizes) {
  const auto male = shape_body(package(), {.sex = Sex::male});
  EXPECT_NEAR(male.stature, 1.748, 1e-3);
  EXPECT_NEAR(male.volume, 65.66e-3, 0.1e-3);
  EXPECT_NEAR(independent_volume(capped_skin(package(), male.points)), male.volume, 1e-9);
  const auto female = shape_body(package(), {.sex = Sex::female});
  EXPECT_NEAR(female.stature, 1.605, 1e-3);
  EXPECT_NEAR(female.volume, 49.85e-3, 0.1e-3);
}

TEST_F(BodyTest, CornersHaveTheKnownVolumes) {
  Macros macros;
  macros.muscle = 0;
  macros.weight = 1;
  EXPECT_NEAR(skin_volume(package(), shape_points(package(), macros)), 122.5e-3, 0.1e-3);
  macros.muscle = 1;
  EXPECT_NEAR(skin_volume(package(), shape_points(package(), macros)), 94.6e-3, 0.1e-3);
  macros = Macros();
  macros.height = 1;
  EXPECT_NEAR(stature(package(), shape_points(package(), macros)), 2.471, 1e-3);
}

TEST_F(BodyTest, HeightsAreMet) {
  for (const auto sex : {Sex::male, Sex::female}) {
    for (const double height : {1.50, 1.65, 1.80}) {
      const auto shaped = shape_body(package(), {.sex = sex, .height = height});
      const auto up = shaped.body.skin.V.col(1);
      EXPECT_NEAR(up.maxCoeff() - up.minCoeff(), height, 1e-3);
      EXPECT_NEAR(up.minCoeff(), 0, 1e-12);
      EXPECT_NEAR(kBodyDensity * independent_volume(capped_skin(package(), shaped.points)),
                  shaped.mass, 1e-6);
    }
  }
}

TEST_F(BodyTest, ImpossibleShapesNameTheRange) {
  const auto message = [](const ShapeSpec& spec) -> std::string {
    try {
      shape_body(package(), spec);
    } catch (const UnfitError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message({.sex = Sex::male, .height = 2.9}).find("1.382 m .. 2.471 m"),
            std::string::npos);
  EXPECT_NE(message({.sex = Sex::male, .height = -1.0}).find("height"), std::string::npos);
  EXPECT_NE(message({.sex = Sex::male, .height = std::numeric_limits<double>::quiet_NaN()})
                .find("height"),
            std::string::npos);
}

TEST(AgeSlider, MeetsTheAnchors) {
  EXPECT_NEAR(age_slider(1), 0, 1e-12);
  EXPECT_NEAR(age_slider(10), 0.1875, 1e-12);
  EXPECT_NEAR(age_slider(25), 0.5, 1e-12);
  EXPECT_NEAR(age_slider(90), 1, 1e-12);
}

}  // namespace
}  // namespace ecorche
