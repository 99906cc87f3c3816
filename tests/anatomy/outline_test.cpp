// Laws of outlines: areas, volumes and motion of sections that are no ellipses, by triangles and
// polygons.
#include "anatomy/muscles/slice_outline.h"
#include "anatomy/posing/section_areas.h"

#include <gtest/gtest.h>

#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/transform_muscles.h"
#include "anatomy/posing/pose_anatomy.h"
#include "tests/anatomy/strips.h"

using namespace ecorche;
using namespace ecorche::testing;

namespace {

constexpr double kPi = std::numbers::pi;

// A blunt shape that is its own image about its centre, differing from slice to slice; `lop` makes
// it uneven.
SliceOutline shape(int slice, double lop = 0) {
  SliceOutline out;
  for (int i = 0; i < kOutlinePoints; ++i) {
    const double angle = 2 * kPi * i / kOutlinePoints;
    out[i] = float(1 + 0.25 * std::cos(2 * angle + 0.3 * slice) +
                   0.1 * std::sin(4 * angle - 0.2 * slice) + lop * std::cos(angle + slice));
  }
  return out;
}

Anatomy shaped_arm(double mirror = 1, double lop = 0) {
  Anatomy anatomy = arm_anatomy(mirror);
  int slice = 0;
  for (Muscle& muscle : anatomy.muscles)
    for (Strip& strip : muscle.strips)
      for (Slice& s : strip.slices) s.outline = shape(slice++, lop);
  return anatomy;
}

Vec2 point(const SliceOutline& outline, const Vec2& radii, int i) {
  const double angle = 2 * kPi * i / kOutlinePoints;
  return double(outline[i % kOutlinePoints]) *
         radii.cwiseProduct(Vec2(std::cos(angle), std::sin(angle)));
}

double polygon_area(const SliceOutline& outline, const Vec2& radii) {
  double area = 0;
  for (int i = 0; i < kOutlinePoints; ++i) {
    const Vec2 p = point(outline, radii, i), q = point(outline, radii, i + 1);
    area += 0.5 * (p.x() * q.y() - p.y() * q.x());
  }
  return area;
}

// Twisted quads between neighbouring rings count as the mean of both ways to halve them; end rings
// are closed by fans.
double mesh_volume(const PosedAnatomy& p, const SliceRange& range) {
  const auto at = [&](int k, int i) -> Vec3 {
    const Ellipse& e = p.slices[k];
    return e.center + e.axes.leftCols<2>() * point(e.outline, e.radii, i);
  };
  const auto tetra = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return a.dot(b.cross(c)) / 6;
  };
  double volume = 0;
  for (int i = 0; i < kOutlinePoints; ++i) {
    for (int k = range.begin; k + 1 < range.end; ++k) {
      const Vec3 a = at(k, i), b = at(k, i + 1), c = at(k + 1, i), d = at(k + 1, i + 1);
      volume += 0.5 * (tetra(a, b, c) + tetra(b, d, c) + tetra(a, b, d) + tetra(a, d, c));
    }
    volume += tetra(p.slices[range.begin].center, at(range.begin, i + 1), at(range.begin, i));
    volume += tetra(p.slices[range.end - 1].center, at(range.end - 1, i), at(range.end - 1, i + 1));
  }
  return volume / (kOutlinePoints / (2 * kPi) * std::sin(2 * kPi / kOutlinePoints));
}

PosedAnatomy posed_outline(const Anatomy& anatomy, const Pose& pose) {
  PosedAnatomy out;
  pose_anatomy(make_posing_table(anatomy), anatomy.skeleton, pose, out);
  return out;
}

}  // namespace

TEST(SliceOutline, AreaIsThePolygons) {
  const Vec2 radii(0.03, 0.01);
  EXPECT_EQ(outline_area(kEllipticOutline), 1);
  for (int k = 0; k < 5; ++k)
    EXPECT_NEAR(outline_area(shape(k, 0.2)),
                polygon_area(shape(k, 0.2), radii) / polygon_area(kEllipticOutline, radii), 1e-12);
}

TEST(SliceOutline, MixedAreaIsThatOfTheSectionBetween) {
  const Vec2 a(0.03, 0.01), b(0.02, 0.016);
  for (int k = 0; k < 5; ++k) {
    const SliceOutline first = shape(k, 0.1), second = shape(k + 2, -0.2);
    double middle = 0;
    for (int i = 0; i < kOutlinePoints; ++i) {
      const Vec2 p = 0.5 * (point(first, a, i) + point(second, b, i)),
                 q = 0.5 * (point(first, a, i + 1) + point(second, b, i + 1));
      middle += 0.5 * (p.x() * q.y() - p.y() * q.x());
    }
    middle /= kOutlinePoints / (2 * kPi) * std::sin(2 * kPi / kOutlinePoints);
    const PieceAreas mixed = piece_areas(first, second);
    const double between = kPi * 0.5 * (mixed.ab * a.x() * b.y() + mixed.ba * b.x() * a.y());
    const double own = kPi * (outline_area(first) * a.prod() + outline_area(second) * b.prod());
    EXPECT_NEAR(own / 4 + between / 2, middle, 1e-12);
  }
}

TEST(SliceOutline, APieceKnowsItsFirstAreaAndIsLopsidedOnlyWhereItsOutlinesAre) {
  const PieceAreas even = piece_areas(shape(0), shape(3)),
                   lop = piece_areas(shape(0, 0.2), shape(3, 0.2));
  EXPECT_NEAR(lop.own, outline_area(shape(0, 0.2)), 1e-12);
  for (const double moment : {even.more_a1, even.more_b1, even.more_a0, even.more_b0})
    EXPECT_NEAR(moment, 0, 1e-7) << "single precision's share";
  EXPECT_GT(std::abs(lop.more_a1) + std::abs(lop.more_b1), 0.01);
  const PieceAreas plain = piece_areas(kEllipticOutline, kEllipticOutline),
                   other_way = piece_areas(shape(3, 0.2), shape(0, 0.2));
  EXPECT_EQ(plain.own, 1);
  EXPECT_EQ(plain.ab, 1);
  EXPECT_NEAR(lop.more_a1, other_way.more_a0, 1e-12);
  EXPECT_NEAR(lop.more_b1, other_way.more_b0, 1e-12);
}

TEST(SliceOutline, FourPiecesAtOnceHaveTheAreasOfEach) {
  std::array<SliceOutline, kLanes> first, second;
  LaneOutlines f, g;
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::size_t at = lane;
    first[at] = shape(lane, 0.2), second[at] = lane < 3 ? shape(lane + 2, -0.1) : kEllipticOutline;
  }
  f.set({&first[0], &first[1], &first[2], &first[3]});
  g.set({&second[0], &second[1], &second[2], &second[3]});
  const PosingAreas all = areas_between(f, g);
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::size_t at = lane;
    const PieceAreas one = piece_areas(first[at], second[at]);
    EXPECT_NEAR(g.own[lane], outline_area(second[at]), 1e-14);
    for (const auto& [lanes, wanted] : {std::pair{all.own, one.own},
                                        {all.ab, one.ab},
                                        {all.ba, one.ba},
                                        {all.aa, one.aa},
                                        {all.bb, one.bb},
                                        {all.more_a1, one.more_a1},
                                        {all.more_b1, one.more_b1},
                                        {all.more_a0, one.more_a0},
                                        {all.more_b0, one.more_b0}})
      EXPECT_NEAR(lanes[lane], wanted, 1e-14) << lane;
  }
}

TEST(SliceOutline, FactorIsLinearBetweenItsPoints) {
  const SliceOutline outline = shape(1);
  EXPECT_FLOAT_EQ(float(outline_factor(outline, 3)), outline[3]);
  EXPECT_NEAR(outline_factor(outline, 15.25),
              0.75 * double(outline[15]) + 0.25 * double(outline[0]), 1e-6);
}

TEST(SliceOutline, FlippedAxesShowTheSamePoints) {
  const SliceOutline outline = shape(3, 0.2);
  for (const bool width : {false, true})
    for (const bool thickness : {false, true}) {
      const SliceOutline flipped = flipped_outline(outline, width, thickness);
      for (int i = 0; i < kOutlinePoints; ++i) {
        Vec2 p = point(outline, Vec2(2, 1), i);
        if (width) p.x() *= -1;
        if (thickness) p.y() *= -1;
        double nearest = 1;
        for (int j = 0; j < kOutlinePoints; ++j)
          nearest = std::min(nearest, (point(flipped, Vec2(2, 1), j) - p).norm());
        EXPECT_LT(nearest, 1e-6) << width << thickness << i;
      }
    }
}

TEST(SliceOutline, RestPoseGivesTheRestOutlines) {
  const Anatomy anatomy = shaped_arm(1, 0.2);
  const auto rest = rest_slices(anatomy);
  const PosedAnatomy p = posed_outline(anatomy, rest_pose(anatomy.skeleton));
  for (std::size_t k = 0; k < rest.size(); ++k) {
    EXPECT_LT((p.slices[k].radii - rest[k].radii).norm(), 1e-12);
    EXPECT_EQ(p.slices[k].outline, rest[k].outline);
    EXPECT_EQ(rest[k].outline, shape(int(k), 0.2));
  }
}

TEST(SliceOutline, VolumeIsTheMeshesAndStaysInMotion) {
  const Anatomy anatomy = shaped_arm();
  const auto ranges = slice_ranges(anatomy);
  const PosedAnatomy rest = posed_outline(anatomy, rest_pose(anatomy.skeleton));
  for (const Pose& pose : {arm_pose(anatomy.skeleton, 0, 0, 0, 0, 0),
                           arm_pose(anatomy.skeleton, 40, 30, 20, 100, 60)}) {
    const PosedAnatomy p = posed_outline(anatomy, pose);
    for (const SliceRange& range : ranges) {
      const double before = strip_volume(rest, range), now = strip_volume(p, range);
      EXPECT_NEAR(now / before, 1, 1e-12) << range.muscle;
      // The mesh closes its ends with the end sections, the tube has none: the same flat caps.
      EXPECT_NEAR(mesh_volume(p, range) / now, 1, 1e-9) << range.muscle;
    }
  }
}

TEST(SliceOutline, DrawnSurfaceHasTheOutlinesPoints) {
  const Anatomy anatomy = shaped_arm(1, 0.2);
  const MuscleSurface surface = make_muscle_surface(anatomy, {kOutlinePoints, false});
  const auto slices = rest_slices(anatomy);
  Points positions;
  update_muscle_surface(surface, slices, positions);
  for (std::size_t k = 0; k < slices.size(); ++k)
    for (int i = 0; i < kOutlinePoints; ++i) {
      const Vec3 wanted = slices[k].center + slices[k].axes.leftCols<2>() *
                                                 point(slices[k].outline, slices[k].radii, i);
      EXPECT_LT((positions.rowwise() - wanted.transpose()).rowwise().norm().minCoeff(), 1e-7);
    }
}

TEST(SliceOutline, GoesWithACarriedStripIntoItsMirrorImage) {
  const Anatomy anatomy = shaped_arm(1, 0.2);
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) {
      const auto from = rest_slices(strip);
      const auto to = rest_slices(carry_strip(strip, [](const Vec3& p, int) -> Vec3 {
        return {-p.x(), p.y(), p.z()};
      }));
      for (std::size_t k = 0; k < from.size(); ++k)
        for (int i = 0; i < kOutlinePoints; ++i) {
          Vec3 p = from[k].center +
                   from[k].axes.leftCols<2>() * point(from[k].outline, from[k].radii, i);
          p.x() *= -1;
          double nearest = 1;
          for (int j = 0; j < kOutlinePoints; ++j)
            nearest = std::min(
                nearest,
                (to[k].center + to[k].axes.leftCols<2>() * point(to[k].outline, to[k].radii, j) - p)
                    .norm());
          EXPECT_LT(nearest, 1e-5) << muscle.name;
        }
    }
}
