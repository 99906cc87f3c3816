// Laws of what shows through: nothing in the reference itself; what lies over its cover, by its
// area; nothing where a border has moved, or where the reference has the two nowhere together.
// Fascia covers.
#include "morph/fit/shown_through.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ecorche {
namespace {

constexpr double kSide = 0.2;    // m, of the wall
constexpr double kLayer = 0.01;  // m

// A flat wall in the plane z = 0, outwards up, in small triangles.
TriMesh flat_wall() {
  constexpr int kCells = 20;
  TriMesh out{Points((kCells + 1) * (kCells + 1), 3), Triangles(2 * kCells * kCells, 3)};
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i)
      out.V.row(j * (kCells + 1) + i) << kSide * i / kCells, kSide * j / kCells, 0;
  int f = 0;
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      const int a = j * (kCells + 1) + i, b = a + 1, c = a + kCells + 1, d = c + 1;
      out.F.row(f++) << a, b, c;
      out.F.row(f++) << b, d, c;
    }
  return out;
}

// A straight muscle along y, `wide` and `thick`, its axis at x and z.
Muscle bar(const std::string& name, double x, double z, double wide, double thick) {
  Muscle out;
  out.name = name;
  out.layer = "superficial";
  Strip& strip = out.strips.emplace_back();
  for (const double y : {-0.1, 0.1, 0.3}) strip.path.push_back({Vec3(x, y, z), {0, -1}, 1});
  strip.reference = Vec3::UnitX();
  for (int k = 0; k <= 20; ++k) {
    Slice& slice = strip.slices.emplace_back();
    slice.s = k / 20.0;
    slice.radii = Vec2(wide / 2, thick / 2);
  }
  strip.rest_length = 0.4;
  return out;
}

struct Scene {
  Anatomy anatomy;
  TriMesh wall = flat_wall();
  FatLayer fat;
  std::vector<VertexPart> parts;

  explicit Scene(std::vector<Muscle> muscles) {
    Joint joint;
    joint.name = "root";
    joint.parent = -1;
    anatomy.skeleton.joints.push_back(joint);
    anatomy.muscles = std::move(muscles);
    fat.thickness.assign(std::size_t(wall.V.rows()), float(kLayer));
    parts.assign(std::size_t(wall.V.rows()), {});
  }
  LayeredBody body() const { return {anatomy, wall, fat, parts}; }
};

// A broad muscle, and a narrow one in the middle, their axes so deep.
Scene layers(double broad, double narrow, double at = 0.1) {
  return Scene({bar("broad", 0.1, broad, 0.6, 0.004), bar("narrow", at, narrow, 0.03, 0.006)});
}

double shown(const Scene& reference, const Scene& scene) {
  return measure_shown_through(order_of_layers(reference.body()), scene.body()).area;
}

TEST(ShownThrough, IsNothingInTheReferenceItself) {
  EXPECT_EQ(shown(layers(-0.015, -0.025), layers(-0.015, -0.025)), 0);
  EXPECT_EQ(shown(layers(-0.025, -0.015), layers(-0.025, -0.015)), 0);
}

TEST(ShownThrough, IsWhatHasComeOverItsCover) {
  const Scene reference = layers(-0.015, -0.025);
  Scene through = layers(-0.022, -0.015);
  through.anatomy.muscles[1].layer = "deep";
  const ShownThrough found =
      measure_shown_through(order_of_layers(reference.body()), through.body());
  EXPECT_NEAR(found.area, 0.03 * kSide, 0.1 * 0.03 * kSide);
  EXPECT_EQ(found.most, "narrow");
  EXPECT_EQ(found.by_one, found.area);
  EXPECT_EQ(found.muscles[0], 0);
  EXPECT_EQ(found.muscles[1], found.area);
  // Of a superficial one the area is told, and nothing asked.
  through.anatomy.muscles[1].layer = "superficial";
  const ShownThrough border =
      measure_shown_through(order_of_layers(reference.body()), through.body());
  EXPECT_EQ(border.muscles[1], found.area);
  EXPECT_EQ(border.by_one, 0);
}

TEST(ShownThrough, KnowsNothingOfBordersThatMove) {
  // Half of the broad one is not there: the narrow one lies free beside it.
  const auto beside = [](double edge) {
    return Scene(
        {bar("broad", edge - 0.15, -0.015, 0.3, 0.004), bar("narrow", 0.1, -0.025, 0.1, 0.006)});
  };
  EXPECT_EQ(shown(beside(0.10), beside(0.085)), 0);
  EXPECT_EQ(shown(beside(0.12), beside(0.06)), 0);
}

// A sheet over all of the wall, so deep.
FasciaSheet sheet_at(double depth, float faded) {
  FasciaSheet out;
  out.rows = out.columns = 2;
  out.V.resize(4, 3);
  out.V << 0, 0, -depth, kSide, 0, -depth, 0, kSide, -depth, kSide, kSide, -depth;
  out.belly.assign(4, faded);
  return out;
}

TEST(ShownThrough, FasciaCovers) {
  const auto under = [](double depth, float faded) {
    Scene scene = layers(-0.015, -0.025);
    scene.anatomy.fascia.push_back(sheet_at(depth, faded));
    return scene;
  };
  Scene through = layers(-0.022, -0.016);
  ASSERT_GT(shown(layers(-0.015, -0.025), through), 0);
  through.anatomy.fascia.push_back(sheet_at(0.0115, 0));
  EXPECT_EQ(shown(layers(-0.015, -0.025), through), 0);
  // The broad muscle comes out over the sheet, but where that passes into the muscle below.
  EXPECT_NEAR(shown(under(0.012, 0), under(0.020, 0)), kSide * kSide, 0.05 * kSide * kSide);
  EXPECT_EQ(shown(under(0.012, 1), under(0.020, 1)), 0);
}

TEST(ShownThrough, IsNothingWhereTheReferenceHasItNowhere) {
  EXPECT_EQ(shown(layers(-0.015, -0.025, 0.03), layers(-0.022, -0.015, 0.16)), 0);
}

}  // namespace
}  // namespace ecorche
