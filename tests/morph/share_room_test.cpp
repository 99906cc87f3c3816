// Laws of sharing: muscles that began in one another end beside one another, out of the bone, under
// the layer, and fill what is between.
#include "morph/dilation/pack_muscles.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/transform_muscles.h"
#include "tests/morph/shapes.h"

namespace ecorche {
namespace {

constexpr double kPiShareRoom = std::numbers::pi;

// A limb of `count` spindles round a bone, each overlapping its neighbours and the bone.
Anatomy limb_share_room(int count) {
  Anatomy anatomy;
  anatomy.skeleton.joints.push_back({});
  anatomy.bones.push_back({"femur", Side::middle, 0, cylinder(0.014, -0.25, 0.25, 32, 40)});
  for (int m = 0; m < count; ++m) {
    const double angle = 2 * kPiShareRoom * m / count + 0.1;
    const Vec3 out(std::cos(angle), 0, std::sin(angle));
    std::vector<PathPoint> path(3);
    for (int p = 0; p < 3; ++p) path[p].rest = 0.028 * out + Vec3(0, -0.18 + 0.18 * p, 0);
    std::vector<Station> stations;
    for (int k = 0; k < 17; ++k) {
      const double s = k / 16.0, r = 0.004 + (m % 2 ? 0.018 : 0.024) * std::sin(kPiShareRoom * s);
      stations.push_back({s, Vec3::Zero(), out, Vec2(r, 0.9 * r)});
    }
    Muscle muscle;
    muscle.name = "muscle" + std::to_string(m);
    muscle.strips.push_back(make_strip(path, stations));
    muscle.volume = rest_volume(muscle);
    anatomy.muscles.push_back(muscle);
  }
  return anatomy;
}

PackingReport share(Anatomy& anatomy, double skin_radius, double layer,
                    const PackingLimits& limits = {}) {
  const TriMesh skin = cylinder(skin_radius, -0.3, 0.3, 96, 60);
  FatLayer fat;
  fat.thickness.assign(std::size_t(skin.V.rows()), float(layer));
  std::vector<Ellipse> slices = rest_slices(anatomy);
  std::vector<double> wanted;
  for (const Muscle& muscle : anatomy.muscles) wanted.push_back(muscle.volume);
  const std::vector<int> partners(anatomy.muscles.size(), -1);
  return pack_muscles(anatomy, slices, wanted, partners, SkinRays(skin), fat, limits);
}

SolidVolumes measure(const Anatomy& anatomy, Points& points) {
  const MuscleSurface surface = make_muscle_surface(anatomy);
  update_muscle_surface(surface, rest_slices(anatomy), points);
  std::vector<Solid> solids;
  for (const auto& part : surface.parts)
    solids.push_back({Solid::Kind::muscle, &points, &surface.F, part.face_begin, part.face_end});
  const TriMesh& bone = anatomy.bones[0].mesh;
  solids.push_back({Solid::Kind::bone, &bone.V, &bone.F, 0, int(bone.F.rows())});
  return measure_solids(solids, 0.5e-3);
}

TEST(ShareRoom, NeighboursPartAndLeaveTheBone) {
  Anatomy anatomy = limb_share_room(5);
  Points points;
  const SolidVolumes before = measure(anatomy, points);
  EXPECT_GT(before.muscle_overlap_share(), 0.1);
  EXPECT_GT(before.bone_overlap_share(), 0.02);
  EXPECT_GT(share(anatomy, 0.06, 0.004).rays, 0);
  const SolidVolumes after = measure(anatomy, points);
  EXPECT_LT(after.muscle_overlap_share(), 0.01);
  EXPECT_LT(after.bone_overlap_share(), 0.003);
}

// Corners of facets may stand into the layer by a quarter of it, the facets themselves stay nearer
// to it.
TEST(ShareRoom, BelliesReachTheLayerAndNoFurther) {
  Anatomy anatomy = limb_share_room(5);
  share(anatomy, 0.064, 0.004);
  Points points;
  measure(anatomy, points);
  const MuscleSurface surface = make_muscle_surface(anatomy);
  std::vector<double> reach(anatomy.muscles.size(), 0);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double far = std::hypot(points(i, 0), points(i, 2));
    EXPECT_LT(far, 0.0611);
    if (std::abs(points(i, 1)) < 0.02)
      reach[surface.muscle[i]] = std::max(reach[surface.muscle[i]], far);
  }
  for (const double far : reach) EXPECT_GT(far, 0.057);
  double sum = 0;
  int facets = 0;
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    const Vec3 middle =
        (points.row(surface.F(f, 0)) + points.row(surface.F(f, 1)) + points.row(surface.F(f, 2)))
            .transpose() /
        3;
    const double far = std::hypot(middle.x(), middle.z());
    if (far > 0.058) sum += far, ++facets;
  }
  EXPECT_GT(facets, 50);
  EXPECT_LT(sum / facets, 0.0606);  // a seventh of the layer
}

// Share of the layer's underside round the middle of the limb that lies within 3 mm of a muscle.
double covered(const Anatomy& anatomy, double radius) {
  const MuscleSurface surface = make_muscle_surface(anatomy);
  Points points;
  update_muscle_surface(surface, rest_slices(anatomy), points);
  int near = 0, all = 0;
  for (int around = 0; around < 60; ++around)
    for (double y = -0.1; y <= 0.1; y += 0.02) {
      const Vec3 p(radius * std::cos(2 * kPiShareRoom * around / 60), y,
                   radius * std::sin(2 * kPiShareRoom * around / 60));
      double least = 1;
      for (Eigen::Index f = 0; f < surface.F.rows(); ++f)
        for (int i = 0; i <= 6; ++i)
          for (int j = 0; i + j <= 6; ++j)
            least = std::min(least,
                             ((i * points.row(surface.F(f, 0)) + j * points.row(surface.F(f, 1)) +
                               (6 - i - j) * points.row(surface.F(f, 2)))
                                      .transpose() /
                                  6 -
                              p)
                                 .norm());
      ++all;
      near += least < 0.003;
    }
  return double(near) / all;
}

TEST(ShareRoom, WhereTheLayerLiesBareTheMuscleUnderItComesUp) {
  Anatomy bare = limb_share_room(5), anatomy = limb_share_room(5);
  PackingLimits without;
  without.covering = 0;
  share(bare, 0.066, 0.004, without);
  share(anatomy, 0.066, 0.004);
  EXPECT_GT(covered(anatomy, 0.062), 0.9);
  EXPECT_LT(covered(bare, 0.062), covered(anatomy, 0.062) - 0.05);
  Points points;
  EXPECT_LT(measure(anatomy, points).muscle_overlap_share(), 0.01);
}

// Two straps that cross where neither has a section.
TEST(ShareRoom, MusclesPartBetweenTheirSections) {
  Anatomy anatomy = limb_share_room(2);
  for (int m = 0; m < 2; ++m) {
    const double side = m ? 1 : -1;
    std::vector<PathPoint> path(2);
    for (int p = 0; p < 2; ++p)
      path[p].rest = Vec3(side * (0.1 - 0.2 * p), 0.2 * p - 0.1, 0.034 + 0.006 * side);
    std::vector<Station> stations;
    for (const double s : {0.0, 0.4, 0.6, 1.0})
      stations.push_back({s, Vec3::Zero(), Vec3::UnitZ(), Vec2(0.012, 0.012)});
    Muscle& muscle = anatomy.muscles[m];
    muscle.strips = {make_strip(path, stations)};
    muscle.volume = rest_volume(muscle);
  }
  Points points;
  const double before = measure(anatomy, points).muscle_overlap_share();
  share(anatomy, 0.2, 0.004);
  const double after = measure(anatomy, points).muscle_overlap_share();
  EXPECT_GT(before, 0.01);
  EXPECT_LT(after, 0.1 * before);
}

TEST(ShareRoom, EllipsesStay) {
  Anatomy anatomy = limb_share_room(4);
  const auto before = rest_slices(anatomy);
  share(anatomy, 0.058, 0.004);
  const auto after = rest_slices(anatomy);
  for (std::size_t k = 0; k < before.size(); ++k) {
    EXPECT_EQ(before[k].center, after[k].center);
    EXPECT_EQ(before[k].radii, after[k].radii);
  }
}

TEST(ShareRoom, SameBytesAtAnyNumberOfThreads) {
  Anatomy one = limb_share_room(6), many = limb_share_room(6);
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    share(one, 0.058, 0.004);
  }
  share(many, 0.058, 0.004);
  const auto a = rest_slices(one), b = rest_slices(many);
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_EQ(a[k].outline, b[k].outline) << k;
}

}  // namespace
}  // namespace ecorche
