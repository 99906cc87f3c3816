// Laws of the figures for muscles that stay whole: nought at rest and for bodies that move as a
// whole; a fold, a needle, muscles that part and a tendon that kinks are each found by their own.
#include "skinning/checks/wholeness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "anatomy/muscles/action_line.h"
#include "tests/anatomy/strips.h"

namespace ecorche {
namespace {

// Two flat straight muscles of 0.3 m, one on the other.
struct Pair {
  Anatomy anatomy;
  MuscleSurface surface;
  std::vector<SliceRange> ranges;
  PosedAnatomy rest;
  RestSurface at_rest;

  Pair() {
    anatomy.skeleton = testing::arm_skeleton();
    for (const double z : {0.0, 0.021}) {
      Muscle muscle;
      muscle.name = z > 0 ? "upper" : "lower";
      muscle.strips = {testing::straight_strap({0, 1, z}, {0, 1.3, z}, 31, {0.04, 0.01})};
      muscle.origin_bone = "bone";  // the other end lies in fascia
      anatomy.muscles.push_back(muscle);
    }
    surface = make_muscle_surface(anatomy);
    ranges = slice_ranges(anatomy);
    rest.slices = rest_slices(anatomy);
    forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), rest.X_WJ);
    rest.belly.assign(rest.slices.size(), 1);
    for (std::size_t k = 24; k <= 30; ++k) rest.belly[k] = 0;  // a tendon at the lower one's end
    at_rest = make_rest_surface(anatomy, surface, ranges, rest, flesh(rest));
  }

  TriMesh flesh(const PosedAnatomy& posed) const {
    TriMesh out{{}, surface.F};
    update_muscle_surface(surface, posed.slices, out.V);
    return out;
  }
  std::vector<MuscleWholeness> measure(const PosedAnatomy& posed) const {
    return measure_wholeness(at_rest, surface, ranges, posed, flesh(posed));
  }
};

TEST(Wholeness, FindsNothingInWhatOnlyMoves) {
  const Pair pair;
  PosedAnatomy posed = pair.rest;
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, -1, 2).normalized()).toRotationMatrix();
  for (Ellipse& e : posed.slices) {
    e.center = turn * e.center + Vec3(1, 2, 3);
    e.axes = turn * e.axes;
  }
  for (Transform& X : posed.X_WJ) X = Eigen::Translation3d(1, 2, 3) * Transform(turn) * X;
  for (const PosedAnatomy& pose : {pair.rest, posed})
    for (const MuscleWholeness& muscle : pair.measure(pose)) {
      EXPECT_EQ(muscle.creased_length, 0);
      EXPECT_EQ(muscle.needles, 0);
      EXPECT_EQ(muscle.daylight, 0);
      EXPECT_EQ(muscle.buried, 0);
      EXPECT_NEAR(muscle.stretch, 1, 1e-6);
      EXPECT_NEAR(muscle.kink, 0, 1e-6);
      EXPECT_NEAR(muscle.end_off, 0, 1e-9);
      EXPECT_GT(muscle.edge_length, 1);
    }
}

TEST(Wholeness, FindsDaylightBetweenMusclesThatPart) {
  const Pair pair;
  PosedAnatomy posed = pair.rest;
  for (std::size_t k = 31; k < 62; ++k) posed.slices[k].center.z() += 0.005;
  EXPECT_EQ(pair.measure(posed)[0].daylight, 0);  // 6 mm apart: not yet
  for (std::size_t k = 31; k < 62; ++k) posed.slices[k].center.z() += 0.015;
  // faces of some 40 x 300 mm that lay within 5 mm of one another
  for (const MuscleWholeness& muscle : pair.measure(posed)) {
    EXPECT_GT(muscle.daylight, 0.008);
    EXPECT_LT(muscle.daylight, 0.030);
  }
}

TEST(Wholeness, FindsOuterFacesThatSinkIntoOthers) {
  const Pair pair;
  PosedAnatomy posed = pair.rest;
  for (std::size_t k = 31; k < 62; ++k) posed.slices[k].center.z() -= 0.010;
  for (const MuscleWholeness& muscle : pair.measure(posed))  // the outer faces are still free
    EXPECT_LT(muscle.buried, 0.001);
  for (std::size_t k = 31; k < 62; ++k) posed.slices[k].center.z() -= 0.015;
  for (const MuscleWholeness& muscle : pair.measure(posed)) {  // of some 80 x 300 mm
    EXPECT_GT(muscle.buried, 0.008);
    EXPECT_LT(muscle.buried, 0.030);
  }
}

TEST(Wholeness, FindsANeedle) {
  const Pair pair;
  PosedAnatomy posed = pair.rest;
  posed.slices[10].outline[0] = 2.5;
  const auto whole = pair.measure(posed);
  EXPECT_GE(whole[0].needles, 1);
  EXPECT_GT(whole[0].creased_length, 0);
  EXPECT_EQ(whole[1].needles, 0);
}

TEST(Wholeness, FindsStretch) {
  const Pair pair;
  PosedAnatomy posed = pair.rest;
  for (std::size_t k = 31; k < 62; ++k) posed.slices[k].radii *= 2;
  const auto whole = pair.measure(posed);
  EXPECT_NEAR(whole[0].stretch, 1, 1e-6);
  EXPECT_NEAR(whole[1].stretch, 2, 0.05);
}

TEST(Wholeness, FindsAnEndOffItsBoneAndNoneInFascia) {
  const Pair pair;
  PosedAnatomy posed = pair.rest;
  posed.slices[0].center.y() -= 0.02;
  posed.slices[61].center.y() += 0.02;
  const auto whole = pair.measure(posed);
  EXPECT_NEAR(whole[0].end_off, 0.02, 1e-9);
  EXPECT_EQ(whole[1].end_off, 0);
}

TEST(Wholeness, FindsAKinkInATendonAlone) {
  const Pair pair;
  PosedAnatomy posed = pair.rest;
  // both turn by a right angle: the lower one where it is tendon, the upper one where it is belly
  for (const std::size_t first : {0u, 31u}) {
    const Vec3 hinge = posed.slices[first + 26].center;
    const Mat3 turn = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()).toRotationMatrix();
    for (std::size_t k = first + 27; k <= first + 30; ++k) {
      posed.slices[k].center = hinge + turn * (posed.slices[k].center - hinge);
      posed.slices[k].axes = turn * posed.slices[k].axes;
    }
  }
  const auto whole = pair.measure(posed);
  EXPECT_NEAR(whole[0].kink, 0.5 * std::numbers::pi / 0.01, 5);  // sections are 10 mm apart
  EXPECT_EQ(whole[1].kink, 0);
}

}  // namespace
}  // namespace ecorche
