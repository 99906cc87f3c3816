// Laws of posing: rest gives rest, rigid motion, mirror and scale, constant volume, no jumps, twist
// spread, same bytes.
#include "anatomy/posing/pose_anatomy.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/anatomy/strips.h"

using namespace ecorche;
using namespace ecorche::testing;

namespace {

PosedAnatomy posed_pose_anatomy(const Anatomy& anatomy, const Pose& pose, int threads = 1) {
  PosedAnatomy out;
  pose_anatomy(make_posing_table(anatomy), anatomy.skeleton, pose, out, threads);
  return out;
}

double distance_pose_anatomy(const Ellipse& a, const Ellipse& b) {
  return (a.center - b.center).norm() + (a.axes - b.axes).norm() + (a.radii - b.radii).norm();
}

// Volume of a tube by its triangles (divergence theorem), 64 points a slice: independent of
// tube_volume.
double mesh_volume_pose_anatomy(const PosedAnatomy& p, const SliceRange& range) {
  constexpr int n = 64;
  const auto at = [&](int k, int i) -> Vec3 {
    const Ellipse& e = p.slices[k];
    const double a = 2 * std::numbers::pi * i / n;
    return e.center + e.axes.col(0) * e.radii.x() * std::cos(a) +
           e.axes.col(1) * e.radii.y() * std::sin(a);
  };
  const auto tetra = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return a.dot(b.cross(c)) / 6;
  };
  double volume = 0;
  for (int i = 0; i < n; ++i) {
    for (int k = range.begin; k + 1 < range.end; ++k) {
      volume += tetra(at(k, i), at(k, i + 1), at(k + 1, i)) +
                tetra(at(k, i + 1), at(k + 1, i + 1), at(k + 1, i));
    }
    volume += tetra(p.slices[range.begin].center, at(range.begin, i + 1), at(range.begin, i));
    volume += tetra(p.slices[range.end - 1].center, at(range.end - 1, i), at(range.end - 1, i + 1));
  }
  // A polygon inscribed in an ellipse has this share of its area.
  return volume / (n / (2 * std::numbers::pi) * std::sin(2 * std::numbers::pi / n));
}

}  // namespace

TEST(PoseAnatomy, RestPoseGivesTheRestEllipses) {
  for (int slices : {2, 3, 5, 13}) {
    const Anatomy anatomy = arm_anatomy(1, 1, slices);
    const auto rest = rest_slices(anatomy);
    const PosedAnatomy p = posed_pose_anatomy(anatomy, rest_pose(anatomy.skeleton));
    ASSERT_EQ(p.slices.size(), rest.size());
    for (size_t k = 0; k < rest.size(); ++k)
      EXPECT_LT(distance_pose_anatomy(p.slices[k], rest[k]), 1e-12) << "slice " << k;
    const auto ranges = slice_ranges(anatomy);
    for (size_t i = 0; i < ranges.size(); ++i) {
      EXPECT_NEAR(p.lengths[i],
                  anatomy.muscles[ranges[i].muscle].strips[ranges[i].strip].rest_length, 1e-12);
      EXPECT_NEAR(p.swelling[i], 1, 1e-12);
      EXPECT_NEAR(p.twists[i], 0, 1e-12);
    }
    EXPECT_EQ(p.clamped, 0);
  }
}

TEST(PoseAnatomy, WrapsOfTheTestArmAreAllUsed) {
  for (const WrapNote& note : wrap_notes(make_posing_table(arm_anatomy())))
    EXPECT_TRUE(note.used) << "muscle " << note.muscle << " wrap " << note.wrap;
}

TEST(PoseAnatomy, MovingTheWholeBodyMovesEverySliceAlike) {
  const Anatomy anatomy = arm_anatomy();
  const Pose still = arm_pose(anatomy.skeleton, 40, 20, 15, 90, 50);
  Pose moved = still;
  const Quat turn(Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()));
  moved.root = Vec3(3, -1, 2);
  moved.rotations[0] = turn;
  const PosedAnatomy a = posed_pose_anatomy(anatomy, still), b = posed_pose_anatomy(anatomy, moved);
  const Transform X = b.X_WJ[0] * a.X_WJ[0].inverse();
  for (size_t k = 0; k < a.slices.size(); ++k) {
    EXPECT_LT((X * a.slices[k].center - b.slices[k].center).norm(), 1e-11);
    EXPECT_LT((X.linear() * a.slices[k].axes - b.slices[k].axes).norm(), 1e-9);
    EXPECT_LT((a.slices[k].radii - b.slices[k].radii).norm(), 1e-11);
  }
}

TEST(PoseAnatomy, TheOtherArmIsTheMirrorImage) {
  const Anatomy left = arm_anatomy(), right = arm_anatomy(-1);
  const PosedAnatomy a = posed_pose_anatomy(left, arm_pose(left.skeleton, 60, 30, 20, 110, 70));
  const PosedAnatomy b =
      posed_pose_anatomy(right, arm_pose(right.skeleton, 60, 30, 20, 110, 70, -1));
  const Eigen::DiagonalMatrix<double, 3> M(-1, 1, 1);
  for (size_t k = 0; k < a.slices.size(); ++k) {
    EXPECT_LT((M * a.slices[k].center - b.slices[k].center).norm(), 1e-9) << k;
    EXPECT_NEAR(std::abs((M * a.slices[k].axes.col(0)).dot(b.slices[k].axes.col(0))), 1, 1e-9) << k;
    EXPECT_LT((a.slices[k].radii - b.slices[k].radii).norm(), 1e-9) << k;
  }
}

TEST(PoseAnatomy, ScaleLaw) {
  const double scale = 1.25;
  const Anatomy one = arm_anatomy(), big = arm_anatomy(1, scale);
  const PosedAnatomy a = posed_pose_anatomy(one, arm_pose(one.skeleton, 10, 40, 20, 110, 70));
  const PosedAnatomy b = posed_pose_anatomy(big, arm_pose(big.skeleton, 10, 40, 20, 110, 70));
  const auto ranges = slice_ranges(one);
  for (size_t i = 0; i < ranges.size(); ++i) {
    // Wrap margins are in metres, so lengths agree to a fraction of a millimetre only where a wrap
    // is met.
    EXPECT_NEAR(b.lengths[i] / scale, a.lengths[i], 5e-4) << i;
    EXPECT_NEAR(strip_volume(b, ranges[i]) / std::pow(scale, 3) / strip_volume(a, ranges[i]), 1,
                1e-6)
        << i;
  }
}

TEST(PoseAnatomy, VolumeIsConstantOverTheRangeOfMotion) {
  const Anatomy anatomy = arm_anatomy();
  const auto ranges = slice_ranges(anatomy);
  const PosedAnatomy rest = posed_pose_anatomy(anatomy, rest_pose(anatomy.skeleton));
  const PosingTable table = make_posing_table(anatomy);
  PosedAnatomy p;
  double worst = 0, worst_mesh = 0, least = 1, most = 1;
  int clamped = 0;
  for (double elbow = 0; elbow <= 140; elbow += 10)
    for (double side = 0; side <= 120; side += 20)
      for (double pronation = -80; pronation <= 80; pronation += 80) {
        pose_anatomy(table, anatomy.skeleton,
                     arm_pose(anatomy.skeleton, side, 0.3 * side, 0, elbow, pronation), p);
        clamped += p.clamped;
        for (const SliceRange& range : ranges) {
          worst = std::max(worst, std::abs(strip_volume(p, range) / strip_volume(rest, range) - 1));
          worst_mesh = std::max(worst_mesh, std::abs(mesh_volume_pose_anatomy(p, range) /
                                                         mesh_volume_pose_anatomy(rest, range) -
                                                     1));
        }
        for (double swelling : p.swelling)
          least = std::min(least, swelling), most = std::max(most, swelling);
      }
  EXPECT_EQ(clamped, 0);
  EXPECT_LT(worst, 1e-9);
  EXPECT_LT(worst_mesh, 0.01);
  RecordProperty("swelling_max", std::to_string(most));
  EXPECT_GT(most, 1.1);  // something swells
  EXPECT_LT(least, 1.0);
}

TEST(PoseAnatomy, TheBicepsBulgesWhenTheElbowBendsAndItsSubstanceMovesUp) {
  const Anatomy anatomy = arm_anatomy();
  const PosedAnatomy rest = posed_pose_anatomy(anatomy, rest_pose(anatomy.skeleton));
  const PosedAnatomy bent =
      posed_pose_anatomy(anatomy, arm_pose(anatomy.skeleton, 0, 0, 0, 120, 0));
  EXPECT_LT(bent.lengths[0], rest.lengths[0] - 0.02);
  EXPECT_GT(bent.swelling[0], 1.05);
  // Below the belly's lower end there is only tendon left where belly was.
  EXPECT_LT(bent.slices[10].radii.x(), rest.slices[9].radii.x());
  double before = 0, after = 0;
  for (int k = 0; k < 13; ++k)
    before = std::max(before, rest.slices[k].radii.x()),
    after = std::max(after, bent.slices[k].radii.x());
  EXPECT_GT(after, 1.04 * before);
}

TEST(PoseAnatomy, SheetsSwellInThicknessOnly) {
  const Anatomy anatomy = arm_anatomy();
  const auto ranges = slice_ranges(anatomy);
  const PosedAnatomy p = posed_pose_anatomy(anatomy, arm_pose(anatomy.skeleton, 0, 60, 0, 0, 0));
  for (const SliceRange& range : ranges) {
    if (!anatomy.muscles[range.muscle].sheet) continue;
    double widest = 0;
    for (int k = range.begin; k < range.end; ++k) widest = std::max(widest, p.slices[k].radii.x());
    EXPECT_LT(widest, 0.0201);
  }
}

// The second difference over steps of one degree is free of the steady motion and shows any jump.
TEST(PoseAnatomy, NothingJumps) {
  const Anatomy anatomy = arm_anatomy();
  const PosingTable table = make_posing_table(anatomy);
  struct Sweep {
    double side, forward, turn, elbow, pronation, to;
    const char* name;
  };
  const Sweep sweeps[] = {{1, 0, 0, 0, 0, 150, "side"},
                          {0, 1, 0, 0, 0, 160, "forward"},
                          {0, 0, 1, 0, 0, 80, "turn"},
                          {0, 0, 0, 1, 0, 138, "elbow"},
                          {0, 0, 0, 0, 1, 85, "pronation"},
                          {1, 0.3, 0.5, 1, 0.6, 140, "all"},
                          {-0.2, -0.4, -0.5, 1, -0.6, 130, "back"}};
  for (const Sweep& sweep : sweeps) {
    std::vector<PosedAnatomy> p(3);
    for (int d = 0; d <= sweep.to; ++d) {
      std::rotate(p.begin(), p.begin() + 1, p.end());
      pose_anatomy(table, anatomy.skeleton,
                   arm_pose(anatomy.skeleton, d * sweep.side, d * sweep.forward, d * sweep.turn,
                            d * sweep.elbow, d * sweep.pronation),
                   p[2]);
      if (d < 2) continue;
      for (size_t k = 0; k < p[2].slices.size(); ++k) {
        const auto rim = [&](int i) -> Vec3 {
          const Ellipse& e = p[i].slices[k];
          return e.center + e.radii.x() * e.axes.col(0);
        };
        const Vec3 center =
            p[2].slices[k].center - 2 * p[1].slices[k].center + p[0].slices[k].center;
        ASSERT_LT(center.norm(), 1e-3) << sweep.name << " at " << d << " deg, slice " << k;
        ASSERT_LT((rim(2) - 2 * rim(1) + rim(0)).norm(), 1e-3)
            << sweep.name << " at " << d << " deg, slice " << k;
        ASSERT_LT((p[2].slices[k].radii - 2 * p[1].slices[k].radii + p[0].slices[k].radii).norm(),
                  1e-3)
            << sweep.name << " at " << d << " deg, slice " << k;
      }
    }
  }
}

TEST(PoseAnatomy, LinesStayOutsideTheirWraps) {
  const Anatomy anatomy = arm_anatomy();
  const PosingTable table = make_posing_table(anatomy);
  PosedAnatomy p;
  for (double elbow = 0; elbow <= 140; elbow += 5)
    for (double side = 0; side <= 120; side += 15) {
      pose_anatomy(table, anatomy.skeleton, arm_pose(anatomy.skeleton, side, 0, 0, elbow, 0), p);
      // Triceps (muscle 2) against the elbow's cylinder, 19 mm about x through the humerus' end;
      // rest offsets are below 3 mm.
      const Transform X = p.X_WJ[1] * Eigen::Translation3d(-Vec3(0.18, 1.45, 0));
      for (int k = 2 * 13 + 1; k < 3 * 13 - 1; ++k) {
        const Vec3 at = X.inverse() * p.slices[k].center;
        if (std::abs(at.y() - 1.15) > 0.05) continue;
        EXPECT_GT(std::hypot(at.y() - 1.15, at.z()), 0.015)
            << "elbow " << elbow << " side " << side << " slice " << k - 26;
      }
    }
}

TEST(PoseAnatomy, TwistIsSpreadAlongTheStrip) {
  Anatomy anatomy = arm_anatomy();
  // A straight strip on the forearm's axis from the elbow joint to the wrist turns at its end by
  // all of the pronation.
  Muscle muscle;
  muscle.name = "axial";
  Strip strip = make_strip({on(2, {0.18, 1.13, 0}), on(3, {0.18, 0.95, 0})},
                           spindle(13, 0.01, 0.004, 0.2, 0.8, Vec3::UnitX()));
  strip.belly_begin = 0.2;
  strip.belly_end = 0.8;
  muscle.strips.push_back(strip);
  anatomy.muscles = {muscle};
  const double deg = std::numbers::pi / 180;
  for (double pronation : {-98.0, -60.0, 30.0, 75.0, 90.0}) {
    const PosedAnatomy p =
        posed_pose_anatomy(anatomy, arm_pose(anatomy.skeleton, 0, 0, 0, 70, pronation));
    EXPECT_NEAR(std::abs(p.twists[0]), std::abs(pronation) * deg, 1e-8);
    // The shares of the turn are kept in single precision.
    double last = 0, sum = 0, softest = 0, stiffest = 1e9;
    for (int k = 1; k < 13; ++k) {
      const double turn = std::acos(
          std::clamp(p.slices[k].axes.col(0).dot(p.slices[k - 1].axes.col(0)), -1.0, 1.0));
      softest = std::max(softest, turn);
      stiffest = std::min(stiffest, turn);
      sum += turn;
      last = turn;
    }
    EXPECT_NEAR(sum, std::abs(pronation) * deg, 1e-6);
    EXPECT_NEAR(softest / stiffest, 3, 1e-5);
    EXPECT_NEAR(last, softest, 1e-6);
  }
  const PosedAnatomy over =
      posed_pose_anatomy(anatomy, arm_pose(anatomy.skeleton, 0, 0, 0, 0, 179));
  EXPECT_EQ(over.overtwisted, 1);
}

TEST(PoseAnatomy, SameBytesAtOneAndTwoThreadsAndAfterAnyHistory) {
  // Copies of the arm until threads are worth it.
  Anatomy anatomy = arm_anatomy();
  const auto muscles = anatomy.muscles;
  while (slice_count(anatomy) < 4000)
    anatomy.muscles.insert(anatomy.muscles.end(), muscles.begin(), muscles.end());
  const PosingTable table = make_posing_table(anatomy);
  const Pose pose = arm_pose(anatomy.skeleton, 50, 20, 10, 100, 60);
  PosedAnatomy one, two;
  pose_anatomy(table, anatomy.skeleton, rest_pose(anatomy.skeleton), two, 2);
  pose_anatomy(table, anatomy.skeleton, pose, one, 1);
  const Ellipse* memory = two.slices.data();
  pose_anatomy(table, anatomy.skeleton, pose, two, 2);
  EXPECT_EQ(memory, two.slices.data());
  EXPECT_EQ(std::memcmp(one.slices.data(), two.slices.data(), one.slices.size() * sizeof(Ellipse)),
            0);
  EXPECT_EQ(
      std::memcmp(one.swelling.data(), two.swelling.data(), one.swelling.size() * sizeof(double)),
      0);
}

TEST(PoseAnatomy, RefusesWhatItCannotPose) {
  Anatomy anatomy = arm_anatomy();
  anatomy.muscles[0].strips[0].slices.resize(1);
  EXPECT_THROW(make_posing_table(anatomy), std::invalid_argument);
  const Anatomy good = arm_anatomy();
  PosedAnatomy out;
  Skeleton small = good.skeleton;
  small.joints.pop_back();
  EXPECT_THROW(pose_anatomy(make_posing_table(good), small, rest_pose(small), out),
               std::invalid_argument);
  EXPECT_THROW(pose_anatomy(PosingTable{}, good.skeleton, rest_pose(good.skeleton), out),
               std::invalid_argument);
}
