#include "morph/body.h"

#include <gtest/gtest.h>

#include <set>

#include "anatomy/errors.h"
#include "tests/body_fixture.h"

namespace ecorche {
namespace {

class BodyTest : public BodyFixture {};

BodySpec spec_of(Sex sex, std::optional<double> height, std::optional<double> mass) {
  BodySpec spec;
  spec.sex = sex;
  spec.height = height;
  spec.mass = mass;
  return spec;
}

double independent_volume(const TriMesh& mesh) {  // by z-columns: sum of signed prisms below each triangle
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
    const double area = 0.5 * ((b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y()));
    sum += area * (a.z() + b.z() + c.z()) / 3;
  }
  return sum;
}

TEST_F(BodyTest, AveragesHaveTheKnownSizes) {
  const auto male = shape_body(package(), spec_of(Sex::male, {}, {}));
  EXPECT_NEAR(male.stature, 1.748, 1e-3);
  EXPECT_NEAR(male.volume, 65.66e-3, 0.1e-3);
  EXPECT_NEAR(independent_volume(capped_skin(package(), male.points)), male.volume, 1e-9);
  const auto female = shape_body(package(), spec_of(Sex::female, {}, {}));
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

TEST_F(BodyTest, HeightAndMassAreMet) {
  for (const auto sex : {Sex::male, Sex::female}) {
    for (const double height : {1.50, 1.65, 1.80, 2.00}) {
      for (const double index : {17.0, 20.0, 25.0, 33.0}) {
        const double mass = index * height * height;
        const auto body = make_body(package(), spec_of(sex, height, mass));
        const auto up = body.skin.V.col(1);
        EXPECT_NEAR(up.maxCoeff() - up.minCoeff(), height, 1e-3);
        EXPECT_NEAR(up.minCoeff(), 0, 1e-12);
        EXPECT_NEAR(kBodyDensity * independent_volume(capped_skin(package(), body.skin.V)), mass, 0.5);
        EXPECT_NEAR(body.mass, mass, 0.5);
      }
    }
  }
}

TEST_F(BodyTest, MuscleIsKeptWhenAskedFor) {
  auto spec = spec_of(Sex::male, 1.80, 85);
  spec.muscle = 0.9;
  const auto shaped = shape_body(package(), spec);
  EXPECT_DOUBLE_EQ(shaped.macros.muscle, 0.9);
  EXPECT_NEAR(shaped.mass, 85, 0.5);
}

TEST_F(BodyTest, ImpossibleWishesNameTheRange) {
  const auto message = [](const BodySpec& spec) -> std::string {
    try {
      make_body(package(), spec);
    } catch (const UnfitError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message(spec_of(Sex::male, 2.9, {})).find("1.382 m .. 2.471 m"), std::string::npos);
  EXPECT_NE(message(spec_of(Sex::male, 1.75, 250)).find("reach"), std::string::npos);
  EXPECT_NE(message(spec_of(Sex::male, 1.75, 30)).find("reach"), std::string::npos);
  EXPECT_NE(message(spec_of(Sex::male, -1.0, {})).find("height"), std::string::npos);
  EXPECT_NE(message(spec_of(Sex::male, std::numeric_limits<double>::quiet_NaN(), {})).find("height"), std::string::npos);
}

TEST_F(BodyTest, BodiesAreMirrorSymmetric) {
  for (const auto& spec : {athlete(), spec_of(Sex::female, 1.6, 80)}) {
    const auto shaped = shape_body(package(), spec);
    double worst = 0;
    for (Eigen::Index i = 0; i < package().skin_size; ++i) {
      const Vec3 here = shaped.points.row(i), there = shaped.points.row(package().mirror[static_cast<std::size_t>(i)]);
      worst = std::max(worst, (here - Vec3(-there.x(), there.y(), there.z())).norm());
    }
    EXPECT_LT(worst, 2e-3);
  }
}

TEST_F(BodyTest, StandardBodiesCanBeMade) {
  std::set<std::string> names;
  auto specs = standard_bodies();
  EXPECT_GE(specs.size(), 10u);
  specs.push_back(athlete());
  for (const auto& spec : specs) {
    const auto body = make_body(package(), spec);
    EXPECT_TRUE(body.skin.V.allFinite());
    EXPECT_TRUE(names.insert(spec.name).second) << spec.name;
    EXPECT_NEAR(body.mass, spec.mass.value_or(body.mass), 0.5) << spec.name;
  }
}

TEST(AgeSlider, MeetsTheAnchors) {
  EXPECT_NEAR(age_slider(1), 0, 1e-12);
  EXPECT_NEAR(age_slider(10), 0.1875, 1e-12);
  EXPECT_NEAR(age_slider(25), 0.5, 1e-12);
  EXPECT_NEAR(age_slider(90), 1, 1e-12);
}

}  // namespace
}  // namespace ecorche
