#include "morph/dilation/dilate_muscles.h"

#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/transform_muscles.h"
#include "morph/dilation/pull_inside_skin.h"
#include "morph/dilation/slice_clearance.h"
#include "morph/fit/containment.h"
#include "tests/morph/shapes.h"

namespace ecorche {
namespace {

constexpr double kPi = 3.14159265358979323846;

// A straight muscle along y at (x, 0), round, tapering to its ends, on one joint that is also the
// bone's.
Anatomy limb(double x, double radius, const char* layer = "superficial") {
  Anatomy anatomy;
  anatomy.skeleton.joints.push_back({});
  anatomy.skeleton.joints[0].name = "hip";
  anatomy.bones.push_back({"femur", Side::middle, 0, cylinder(0.012, -0.2, 0.2, 24, 10)});
  Muscle muscle;
  muscle.name = "muscle";
  muscle.layer = layer;
  std::vector<PathPoint> path(3);
  for (int p = 0; p < 3; ++p) path[p].rest = Vec3(x, -0.15 + 0.15 * p, 0);
  std::vector<Station> stations;
  for (int k = 0; k < 15; ++k) {
    const double s = k / 14.0, r = radius * (0.3 + 0.7 * std::sin(kPi * s));
    stations.push_back({s, Vec3::Zero(), Vec3::UnitX(), Vec2(r, r)});
  }
  muscle.strips.push_back(make_strip(path, stations));
  muscle.volume = rest_volume(muscle);
  anatomy.muscles.push_back(muscle);
  return anatomy;
}

FatLayer even_layer(const TriMesh& skin, double thickness) {
  FatLayer fat;
  fat.thickness.assign(std::size_t(skin.V.rows()), float(thickness));
  return fat;
}

double farthest_from_axis(const Anatomy& anatomy) {
  double most = 0;
  for (const Ellipse& e : rest_slices(anatomy)) {
    for (int k = 0; k < 72; ++k) {
      const Vec3 p = e.center + e.radii.x() * std::cos(k * kPi / 36) * e.axes.col(0) +
                     e.radii.y() * std::sin(k * kPi / 36) * e.axes.col(1);
      most = std::max(most, std::hypot(p.x(), p.z()));
    }
  }
  return most;
}

TEST(SkinRays, MeetsTheSkinWhereItIs) {
  const SkinRays rays(cylinder(0.1, -0.3, 0.3));
  const RayHit hit = rays.first_hit(Vec3(0.02, 0.01, 0), Vec3::UnitX());
  ASSERT_GE(hit.triangle, 0);
  EXPECT_NEAR(hit.distance, 0.08, 1e-4);
  EXPECT_GT(hit.facing, 0.99f);
  EXPECT_LT(rays.first_hit(Vec3(0.2, 0, 0), -Vec3::UnitX()).facing, -0.99f);
  EXPECT_LT(rays.first_hit(Vec3(0.2, 0, 0), Vec3::UnitX()).triangle, 0);
  EXPECT_LT(rays.first_hit(Vec3::Zero(), Vec3::UnitX(), 0.05).triangle, 0);
  EXPECT_THROW(SkinRays(TriMesh{Points(0, 3), Triangles(0, 3)}), std::invalid_argument);
}

TEST(SkinRays, NoneSlipsThroughAClosedSkin) {
  const SkinRays rays(cylinder(0.1, -0.3, 0.3));
  int misses = 0;
  for (int k = 0; k < 20000; ++k) {
    const double a = k * 2.399963, y = 1 - 2 * (k + 0.5) / 20000;
    misses += rays.first_hit(Vec3(0.03, 0.1, -0.02), Vec3(std::cos(a) * std::sqrt(1 - y * y), y,
                                                          std::sin(a) * std::sqrt(1 - y * y)))
                  .triangle < 0;
  }
  EXPECT_EQ(misses, 0);
}

TEST(SliceRoom, PressesOnTheSideThatStandsOut) {
  const std::vector<HalfPlane> room{{Vec2::UnitX(), 0.01, 0}, {-Vec2::UnitX(), 0.05, 0}};
  SliceSection section{Vec2::Zero(), Vec2(0.016, 0.01)};
  press_in(section, room, 0.35);
  EXPECT_NEAR(section.center.x() + section.radii.x(), 0.01, 1e-4);
  EXPECT_NEAR(section.center.x() - section.radii.x(), -0.016, 1e-3);  // the other side stays
  EXPECT_NEAR(section.radii.y(), 0.01, 1e-9);
}

TEST(SliceRoom, GrowsUntilItTouches) {
  std::vector<HalfPlane> room;
  for (int k = 0; k < 20; ++k) {
    const Vec2 n(std::cos(k * kPi / 10), std::sin(k * kPi / 10));
    room.push_back({n, n.x() > 0.3 ? 0.03 : 0.2, 0});
  }
  SliceSection section{Vec2::Zero(), Vec2(0.01, 0.01)};
  const Vec2 growth = growth_to_touch(section, room);
  section.center += growth;
  section.radii += growth.cwiseAbs();
  EXPECT_NEAR(worst_excess(section, room), 0, 1e-6);
  EXPECT_NEAR(section.center.x() - section.radii.x(), -0.01, 1e-9);
}

TEST(Dilate, APaperMuscleAtTheCentreFillsTheSkinLessTheLayer) {
  const TriMesh skin = cylinder(0.06, -0.3, 0.3);
  const SkinRays rays(skin);
  const Anatomy original = limb(0, 0.02);
  DilateOptions options;
  options.method = DilateMethod::paper;
  for (const bool cut : {true, false}) {
    options.cut_rays = cut;
    Anatomy fitted = original;
    const DilateReport report = dilate_muscles(fitted, original.muscles, original.muscles, rays,
                                               even_layer(skin, 0.01), options);
    EXPECT_NEAR(farthest_from_axis(fitted), 0.05, 2e-4);
    EXPECT_NEAR(report.muscles[0].factor, 0.05 / (0.4 * 0.02), 0.05);
    EXPECT_EQ(report.misses, 0);
    EXPECT_EQ(report.rays, 15 * 20);
  }
}

// The layer is soft: a section may press into it by half.
TEST(Dilate, MusclesInTheFatLieUnderTheSkinAlone) {
  const TriMesh skin = cylinder(0.06, -0.3, 0.3);
  const SkinRays rays(skin);
  FatLayer fat = even_layer(skin, 0.01);
  fat.skin.assign(fat.thickness.size(), 0.0015f);
  const auto farthest = [&](const char* layer) {
    const Anatomy original = limb(0.055, 0.0015, layer);
    Anatomy fitted = original;
    dilate_muscles(fitted, original.muscles, original.muscles, rays, fat, {});
    return farthest_from_axis(fitted);
  };
  EXPECT_LT(farthest("superficial"), 0.0555);  // half-way into the layer at most
  EXPECT_NEAR(farthest("subcutaneous"), 0.0565, 1e-3);
  // of a layer whose skin is not known all counts as skin
  fat.skin.clear();
  EXPECT_LT(farthest("subcutaneous"), 0.0555);
}

TEST(Dilate, ASuperficialMuscleReachesTheLayerAndStaysUnderTheSkin) {
  const TriMesh skin = cylinder(0.06, -0.3, 0.3);
  const SkinRays rays(skin);
  const Anatomy original = limb(0.03, 0.015);
  Anatomy fitted = original;
  const DilateReport report =
      dilate_muscles(fitted, original.muscles, original.muscles, rays, even_layer(skin, 0.006));
  EXPECT_GT(farthest_from_axis(fitted), 0.0525);
  EXPECT_LT(farthest_from_axis(fitted), 0.0572);
  EXPECT_GT(report.volume, report.target_volume);
  EXPECT_EQ(fitted.muscles[0].volume, report.muscles[0].volume);
  EXPECT_EQ(report.misses, 0);
}

TEST(Dilate, AMuscleThatStandsOutComesInside) {
  const TriMesh skin = cylinder(0.06, -0.3, 0.3);
  const SkinRays rays(skin);
  for (const double x : {0.055, 0.066}) {  // its line inside, its line outside
    const Anatomy original = limb(x, 0.015);
    Anatomy fitted = original;
    dilate_muscles(fitted, original.muscles, original.muscles, rays, even_layer(skin, 0.006));
    EXPECT_LT(farthest_from_axis(fitted), 0.0595) << x;
    EXPECT_GT(rest_volume(fitted.muscles[0]), 0.1 * rest_volume(original.muscles[0])) << x;
  }
}

void expect_same_sections(const Anatomy& a, const Anatomy& b) {
  const auto one = rest_slices(a), other = rest_slices(b);
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    ASSERT_LT((one[k].center - other[k].center).norm(), 1e-12) << k;
    ASSERT_LT((one[k].radii - other[k].radii).norm(), 1e-12) << k;
  }
}

TEST(Dilate, GrowingAgainChangesNothing) {
  const TriMesh skin = cylinder(0.06, -0.3, 0.3);
  const SkinRays rays(skin);
  const Anatomy original = limb(0.03, 0.015);
  for (const DilateMethod method : {DilateMethod::ecorche, DilateMethod::paper}) {
    DilateOptions options;
    options.method = method;
    Anatomy once = original;
    dilate_muscles(once, original.muscles, original.muscles, rays, even_layer(skin, 0.006),
                   options);
    EXPECT_GT(std::abs(rest_volume(once.muscles[0]) / rest_volume(original.muscles[0]) - 1), 0.05);
    Anatomy again = once;
    dilate_muscles(again, original.muscles, original.muscles, rays, even_layer(skin, 0.006),
                   options);
    expect_same_sections(once, again);
  }
}

// The factor makes up for what alpha takes away.
TEST(Dilate, AlphaIsTheShareThatThePaperStartsFrom) {
  const TriMesh skin = cylinder(0.06, -0.3, 0.3);
  const SkinRays rays(skin);
  const Anatomy original = limb(0.02, 0.02);
  DilateOptions options;
  options.method = DilateMethod::paper;
  Anatomy usual = original, narrow = original;
  const DilateReport at_usual = dilate_muscles(usual, original.muscles, original.muscles, rays,
                                               even_layer(skin, 0.01), options);
  options.alpha = 0.2;
  const DilateReport at_narrow = dilate_muscles(narrow, original.muscles, original.muscles, rays,
                                                even_layer(skin, 0.01), options);
  EXPECT_NEAR(at_narrow.muscles[0].factor / at_usual.muscles[0].factor, 2, 1e-9);
  expect_same_sections(usual, narrow);
  options.alpha = 0;
  EXPECT_THROW(dilate_muscles(narrow, original.muscles, original.muscles, rays,
                              even_layer(skin, 0.01), options),
               std::invalid_argument);
}

// Caps reach past the first and last sections, which the rays of the sections do not see.
TEST(KeepInside, PressesWhatTheSectionsDoNotSee) {
  const TriMesh skin = cylinder(0.06, -0.153, 0.153);
  const SkinRays rays(skin);
  Anatomy anatomy = limb(0.03, 0.015);  // ends at y = -0.15 and 0.15, with caps of 4.5 mm
  std::vector<Ellipse> slices = rest_slices(anatomy);
  const std::vector<char> suspects{1};
  const InsideReport report = pull_inside_skin(anatomy.muscles, slices, suspects, rays);
  EXPECT_GT(report.outside, 0);
  EXPECT_EQ(report.left, 0);
  const MuscleSurface surface = make_muscle_surface(anatomy);
  Points positions;
  update_muscle_surface(surface, rest_slices(anatomy), positions);
  EXPECT_LT(positions.col(1).cwiseAbs().maxCoeff(), 0.153);
  EXPECT_GT(rest_volume(anatomy.muscles[0]), 0.8 * rest_volume(limb(0.03, 0.015).muscles[0]));
  const InsideReport again = pull_inside_skin(anatomy.muscles, slices, suspects, rays);
  EXPECT_EQ(again.outside, 0);
}

TEST(Dilate, GivesTheSameBytesAtAnyNumberOfThreads) {
  const TriMesh skin = cylinder(0.06, -0.3, 0.3);
  const SkinRays rays(skin);
  Anatomy original = limb(0.03, 0.015);
  for (int m = 0; m < 20; ++m) original.muscles.push_back(limb(0.02 + 0.001 * m, 0.01).muscles[0]);
  const auto slices = [&](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(threads));
    Anatomy fitted = original;
    dilate_muscles(fitted, original.muscles, original.muscles, rays, even_layer(skin, 0.006));
    return rest_slices(fitted);
  };
  const auto one = slices(1), two = slices(2);
  for (std::size_t k = 0; k < one.size(); ++k) {
    ASSERT_TRUE(one[k].center == two[k].center && one[k].radii == two[k].radii) << k;
  }
}

TEST(Containment, CountsWhatStandsOut) {
  const TriMesh skin = cylinder(0.06, -0.3, 0.3);
  Anatomy anatomy = limb(0.03, 0.015);
  const Containment inside = check_containment(anatomy, skin);
  EXPECT_EQ(inside.bone_points_outside + inside.muscle_points_outside, 0);
  EXPECT_EQ(inside.bone_points, anatomy.bones[0].mesh.V.rows());
  EXPECT_EQ(inside.muscle_points, 16 * 15);
  anatomy.bones[0].mesh.V.row(3) << 0.061, 0, 0;
  anatomy.muscles.push_back(limb(0.2, 0.01).muscles[0]);
  const Containment outside = check_containment(anatomy, skin);
  EXPECT_EQ(outside.bones[0], 1);
  EXPECT_EQ(outside.muscles[0], 0);
  EXPECT_EQ(outside.muscles[1], 16 * 15);
}

TEST(Containment, RefusesAnOpenSkin) {
  TriMesh open = cylinder(0.06, -0.3, 0.3);
  open.F.conservativeResize(open.F.rows() - 1, 3);
  EXPECT_THROW(check_containment(limb(0.03, 0.015), open), std::invalid_argument);
}

TEST(Dilate, RefusesWhatDoesNotMatch) {
  const TriMesh skin = cylinder(0.06, -0.3, 0.3);
  const SkinRays rays(skin);
  Anatomy one = limb(0.03, 0.015), other = one;
  other.muscles.clear();
  EXPECT_THROW(dilate_muscles(one, one.muscles, other.muscles, rays, even_layer(skin, 0.006)),
               std::invalid_argument);
  EXPECT_THROW(dilate_muscles(one, one.muscles, Anatomy(one).muscles, rays, FatLayer{}),
               std::invalid_argument);
  DilateOptions options;
  options.rays = 3;
  EXPECT_THROW(dilate_muscles(one, one.muscles, Anatomy(one).muscles, rays, even_layer(skin, 0.006),
                              options),
               std::invalid_argument);
}

}  // namespace
}  // namespace ecorche
