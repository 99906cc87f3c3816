// Muscles that get slimmer keep their outer side, to which the skin is nearest.
#include "morph/dilation/slim_muscles.h"

#include <gtest/gtest.h>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/transform_muscles.h"
#include "tests/morph/shapes.h"

namespace ecorche {
namespace {

// A spindle beside the axis of a limb, towards +x.
Muscle spindle(const Vec3& width) {
  std::vector<PathPoint> path(3);
  for (int p = 0; p < 3; ++p) path[p].rest = Vec3(0.03, -0.18 + 0.18 * p, 0);
  std::vector<Station> stations;
  for (int k = 0; k < 17; ++k) {
    const double s = k / 16.0, r = 0.004 + 0.016 * std::sin(std::numbers::pi * s);
    stations.push_back({s, Vec3::Zero(), width, Vec2(r, 0.8 * r)});
  }
  Muscle muscle;
  muscle.name = "belly";
  muscle.layer = "superficial";
  muscle.strips.push_back(make_strip(path, stations));
  muscle.volume = rest_volume(muscle);
  return muscle;
}

// How far a section goes along x, to one side.
double reach(const Ellipse& e, double side) {
  return side * e.center.x() + std::hypot(e.axes(0, 0) * e.radii.x(), e.axes(0, 1) * e.radii.y());
}

TEST(SlimMuscles, KeepTheirOuterSide) {
  const SkinRays rays(cylinder(0.06, -0.3, 0.3));
  // Width to the skin, to the bone and along the skin: of their axes none says where the skin is.
  for (const Vec3& width : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    std::vector<Muscle> muscles{spindle(width)};
    Anatomy anatomy;
    anatomy.muscles = muscles;
    std::vector<Ellipse> slices = rest_slices(anatomy);
    const std::vector<Ellipse> before = slices;
    const std::vector<double> wanted{muscles[0].volume};
    const double total = 0.75 * muscles[0].volume;
    EXPECT_NEAR(slim_muscles(muscles, slices, wanted, std::vector<int>{-1}, total, rays), total,
                0.01 * total);
    const Ellipse &was = before[8], &is = slices[8];
    const double outer = reach(was, 1) - reach(is, 1), inner = reach(was, -1) - reach(is, -1);
    EXPECT_GT(inner, 2e-3) << width.transpose();
    EXPECT_LT(outer, 0.15 * inner) << width.transpose();
    // thinner by more than narrower
    EXPECT_GT(was.radii.prod() / is.radii.prod(), 1.2);
  }
}

TEST(SlimMuscles, TheBellysWallHoldsItsOwnVolumeWhateverTheOthersHold) {
  const SkinRays rays(cylinder(0.06, -0.3, 0.3));
  std::vector<Muscle> muscles{spindle(Vec3(0, 0, 1)), spindle(Vec3(0, 0, 1))};
  muscles[0].group = "trunk_abdomen";
  muscles[1].group = "thigh";
  Anatomy anatomy;
  anatomy.muscles = muscles;
  std::vector<Ellipse> slices = rest_slices(anatomy);
  const std::vector<Ellipse> before = slices;
  const double volume = muscles[0].volume;
  const std::vector<double> wanted{0.5 * volume, volume};
  const double held =
      slim_muscles(muscles, slices, wanted, std::vector<int>{-1, -1}, 1.5 * volume, rays);
  EXPECT_NEAR(held, 1.5 * volume, 0.03 * volume);
  const std::size_t middle = 8, half = slices.size() / 2;
  EXPECT_NEAR(slices[middle].radii.prod() / before[middle].radii.prod(), 0.5, 0.01);
  EXPECT_LT(reach(before[middle], 1) - reach(slices[middle], 1), 2e-3);
  for (std::size_t k = half; k < slices.size(); ++k)
    EXPECT_EQ(slices[k].radii, before[k].radii) << k;
}

}  // namespace
}  // namespace ecorche
