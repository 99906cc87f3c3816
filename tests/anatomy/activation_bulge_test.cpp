// Laws of the shape that effort gives to a muscle whose joints hold still.
#include <gtest/gtest.h>

#include <cmath>

#include "anatomy/posing/pose_anatomy.h"
#include "tests/anatomy/strips.h"

using namespace ecorche;
using namespace ecorche::testing;

namespace {

// Of every section: radii alike, and an outline that is `flat` times as thick as it is wide, turned
// in its axes by `aslant`, rad.
Anatomy flattened_arm(float flat, double aslant = 0) {
  Anatomy anatomy = arm_anatomy();
  for (Muscle& muscle : anatomy.muscles)
    for (Strip& strip : muscle.strips)
      for (Slice& slice : strip.slices) {
        slice.radii.y() = slice.radii.x();
        for (std::size_t k = 0; k < slice.outline.size(); ++k) {
          const double angle = 2 * std::numbers::pi * double(k) / kOutlinePoints - aslant;
          slice.outline[k] =
              flat / std::hypot(flat * float(std::cos(angle)), float(std::sin(angle)));
        }
      }
  return anatomy;
}

struct Arm {
  Anatomy anatomy;
  PosingTable table = make_posing_table(anatomy);
  std::vector<SliceRange> ranges = slice_ranges(anatomy);

  PosedAnatomy posed(double effort) const {
    PosedAnatomy out;
    pose_anatomy(table, anatomy.skeleton, rest_pose(anatomy.skeleton), out, 1,
                 std::vector<double>(anatomy.muscles.size(), effort));
    return out;
  }
  // The section nearest to the middle of a strip's belly.
  int middle(const SliceRange& range) const {
    const Strip& strip = anatomy.muscles[range.muscle].strips[range.strip];
    const double at = 0.5 * (strip.belly_begin + strip.belly_end);
    int out = 0;
    for (std::size_t k = 0; k < strip.slices.size(); ++k)
      if (std::abs(strip.slices[k].s - at) < std::abs(strip.slices[out].s - at)) out = int(k);
    return range.begin + out;
  }
};

Arm measured_arm(double tense_thickness) {
  Arm out{flattened_arm(0.6f)};
  for (Muscle& muscle : out.anatomy.muscles) muscle.tense_thickness = tense_thickness;
  out.table = make_posing_table(out.anatomy);
  return out;
}

// Half the width of a section that is centrally symmetric, along a direction.
double reach(const Ellipse& section, const Vec3& direction) {
  double out = 0;
  for (std::size_t k = 0; k < section.outline.size(); ++k) {
    const double angle = 2 * std::numbers::pi * double(k) / kOutlinePoints;
    const Vec3 rim = section.radii.x() * std::cos(angle) * section.axes.col(0) +
                     section.radii.y() * std::sin(angle) * section.axes.col(1);
    out = std::max(out, double(section.outline[k]) * rim.dot(direction));
  }
  return out;
}

// Thickness over width, against the relaxed section.
double rounder(const PosedAnatomy& tense, const PosedAnatomy& relaxed, int k) {
  const Vec2 now = tense.slices[k].radii, before = relaxed.slices[k].radii;
  return now.y() * before.x() / (now.x() * before.y());
}

}  // namespace

TEST(Bulge, MeasuredMusclesThickenAsMeasured) {
  for (const double measured : {0.9, 1.0, 1.2, 1.5}) {
    const Arm arm = measured_arm(measured);
    const PosedAnatomy relaxed = arm.posed(0), tense = arm.posed(1);
    for (const SliceRange& range : arm.ranges) {
      const int k = arm.middle(range);
      const double thicker = tense.slices[k].radii.y() / relaxed.slices[k].radii.y();
      EXPECT_NEAR(thicker / measured, 1, 0.06)  // what keeping the volume takes
          << arm.anatomy.muscles[range.muscle].name;
    }
  }
}

// Fitted among their neighbours, outlines come to lie aslant in their axes.
TEST(Bulge, SectionsThickenWhereTheyAreThinHoweverTheyLie) {
  constexpr double measured = 1.4;
  for (const double aslant : {-1.2, -0.6, 0.4, 0.9, 1.5}) {
    Arm arm{flattened_arm(0.6f, aslant)};
    for (Muscle& muscle : arm.anatomy.muscles) muscle.tense_thickness = measured;
    arm.table = make_posing_table(arm.anatomy);
    const PosedAnatomy relaxed = arm.posed(0), tense = arm.posed(1);
    for (const SliceRange& range : arm.ranges) {
      const Muscle& muscle = arm.anatomy.muscles[range.muscle];
      if (muscle.sheet) continue;  // its strips lie side by side
      const int k = arm.middle(range);
      const Mat3& axes = relaxed.slices[k].axes;
      const Vec3 thin = std::cos(aslant) * axes.col(1) - std::sin(aslant) * axes.col(0);
      EXPECT_NEAR(reach(tense.slices[k], thin) / reach(relaxed.slices[k], thin) / measured, 1, 0.06)
          << muscle.name << ' ' << aslant;
      EXPECT_LT(reach(tense.slices[k], thin.cross(axes.col(2))),
                reach(relaxed.slices[k], thin.cross(axes.col(2))))
          << muscle.name << ' ' << aslant;
      EXPECT_NEAR(strip_volume(tense, range) / strip_volume(relaxed, range), 1, 1e-9)
          << muscle.name;
    }
  }
}

TEST(Bulge, MoreEffortThickensSteadily) {
  for (const double measured : {0.0, 1.4}) {
    const Arm arm = measured_arm(measured);
    PosedAnatomy before = arm.posed(0);
    for (const double effort : {0.02, 0.1, 0.3, 0.6, 1.0}) {
      const PosedAnatomy now = arm.posed(effort);
      for (const SliceRange& range : arm.ranges) {
        const int k = arm.middle(range);
        EXPECT_GT(now.slices[k].radii.y(), before.slices[k].radii.y())
            << arm.anatomy.muscles[range.muscle].name << " at " << effort;
      }
      before = now;
    }
  }
}

TEST(Bulge, KeepsTheVolumeOfWhatThickens) {
  const Arm arm = measured_arm(1.5);
  const PosedAnatomy relaxed = arm.posed(0), tense = arm.posed(1);
  for (const SliceRange& range : arm.ranges)
    EXPECT_NEAR(strip_volume(tense, range) / strip_volume(relaxed, range), 1, 1e-9)
        << arm.anatomy.muscles[range.muscle].name;
}

TEST(Bulge, RoundSectionsStayRound) {
  const Arm arm{flattened_arm(1)};
  const PosedAnatomy relaxed = arm.posed(0), tense = arm.posed(1);
  for (const SliceRange& range : arm.ranges) {
    if (arm.anatomy.muscles[range.muscle].sheet) continue;
    for (int k = range.begin; k < range.end; ++k)
      EXPECT_NEAR(rounder(tense, relaxed, k), 1, 1e-6) << arm.anatomy.muscles[range.muscle].name;
  }
}

// Radii alike do not make a section round.
TEST(Bulge, OutlinesThatAreFlatTurnRounderEitherWay) {
  for (const float flat : {0.5f, 1 / 0.5f}) {
    const Arm arm{flattened_arm(flat)};
    const PosedAnatomy relaxed = arm.posed(0), tense = arm.posed(1);
    for (const SliceRange& range : arm.ranges) {
      if (arm.anatomy.muscles[range.muscle].sheet) continue;
      const double change = std::log(rounder(tense, relaxed, arm.middle(range)));
      EXPECT_NEAR(change / -std::log(flat), 0.3, 0.03) << arm.anatomy.muscles[range.muscle].name;
    }
  }
}

TEST(Bulge, SheetsOfUnmeasuredMusclesKeepTheirWidth) {
  const Arm arm{flattened_arm(0.5f)};
  const PosedAnatomy relaxed = arm.posed(0), tense = arm.posed(1);
  for (const SliceRange& range : arm.ranges) {
    if (!arm.anatomy.muscles[range.muscle].sheet) continue;
    const int k = arm.middle(range);
    EXPECT_NEAR(tense.slices[k].radii.x(), relaxed.slices[k].radii.x(), 1e-12);
    EXPECT_GT(tense.slices[k].radii.y(), relaxed.slices[k].radii.y());
  }
}
