// Laws of muscle surfaces: closed, outward, of the slices' volume, at rest and in motion.
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"

#include <gtest/gtest.h>

#include <map>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/transform_muscles.h"

#include "tests/anatomy/strips.h"

using namespace ecorche;
using namespace ecorche::testing;

namespace {

// Every directed edge once, its opposite once.
bool closed(const Triangles& F) {
  std::map<std::pair<int, int>, int> edges;
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    for (int i = 0; i < 3; ++i) ++edges[{F(f, i), F(f, (i + 1) % 3)}];
  for (const auto& [edge, count] : edges)
    if (count != 1 || edges.count({edge.second, edge.first}) != 1) return false;
  return true;
}

PosedAnatomy posed(const Anatomy& anatomy, const Pose& pose) {
  PosedAnatomy out;
  pose_anatomy(make_posing_table(anatomy), anatomy.skeleton, pose, out);
  return out;
}

}  // namespace

TEST(MuscleSurface, EveryMuscleIsClosed) {
  const Anatomy anatomy = arm_anatomy();
  for (bool loft : {false, true}) {
    const MuscleSurface surface = make_muscle_surface(anatomy, {16, loft});
    ASSERT_EQ(surface.parts.size(), anatomy.muscles.size());
    for (const auto& part : surface.parts) {
      EXPECT_TRUE(closed(surface.F.middleRows(part.face_begin, part.face_end - part.face_begin)))
          << part.muscle;
      EXPECT_EQ(part.sheet, loft && anatomy.muscles[part.muscle].sheet);
    }
  }
}

TEST(MuscleSurface, IntersectionsAndRaphesArePale) {
  Anatomy anatomy;
  anatomy.skeleton = arm_skeleton();
  std::vector<Station> stations(21);
  for (std::size_t k = 0; k < stations.size(); ++k) {
    stations[k].s = double(k) / 20;
    stations[k].radii = {0.04, 0.01};
  }
  for (const Side side : {Side::left, Side::right}) {
    Muscle muscle;
    muscle.name = "wall";
    muscle.side = side;
    muscle.strips.push_back(make_strip({on(0, {0, 1, 0}), on(0, {0, 1.4, 0})}, stations));
    muscle.strips[0].intersections = {0.5};
    muscle.strips[0].raphe = 0.1;
    anatomy.muscles = {muscle};
    const MuscleSurface surface = make_muscle_surface(anatomy);
    Points positions;
    update_muscle_surface(surface, rest_slices(anatomy), positions);
    for (std::size_t v = 0; v < surface.belly.size(); ++v) {
      if (surface.slice[v] == 0 || surface.slice[v] == 20) continue;  // caps are narrower
      const double lateral = positions(Eigen::Index(v), 0) * (side == Side::left ? 1 : -1);
      const float belly = surface.belly[v];
      if (surface.slice[v] == 10 || lateral < -0.036)
        EXPECT_EQ(belly, 0) << lateral;
      else if (lateral > -0.02)
        EXPECT_GT(belly, 0.99f) << lateral;
    }
  }
}

TEST(MuscleSurface, TubesEncloseTheVolumeOfTheirSlices) {
  const Anatomy anatomy = arm_anatomy();
  const MuscleSurface surface = make_muscle_surface(anatomy, {32, false});
  Points positions;
  update_muscle_surface(surface, rest_slices(anatomy), positions);
  for (const auto& part : surface.parts)
    EXPECT_NEAR(part_volume(surface, part, positions) / rest_volume(anatomy.muscles[part.muscle]),
                1, 0.012)
        << part.muscle;
}

TEST(MuscleSurface, SheetsHaveTheVolumeOfTheirStripsAtRest) {
  const Anatomy anatomy = arm_anatomy();
  const MuscleSurface surface = make_muscle_surface(anatomy);
  Points positions;
  update_muscle_surface(surface, rest_slices(anatomy), positions);
  for (const auto& part : surface.parts)
    if (part.sheet) {
      EXPECT_NEAR(part_volume(surface, part, positions) / rest_volume(anatomy.muscles[part.muscle]),
                  1, 0.005);
    }
}

TEST(MuscleSurface, VolumeStaysInMotion) {
  const Anatomy anatomy = arm_anatomy();
  const MuscleSurface surface = make_muscle_surface(anatomy, {16, false});
  Points rest, moved;
  update_muscle_surface(surface, rest_slices(anatomy), rest);
  for (double elbow : {30.0, 90.0, 130.0})
    for (double side : {0.0, 60.0, 110.0}) {
      update_muscle_surface(
          surface, posed(anatomy, arm_pose(anatomy.skeleton, side, 20, 10, elbow, 60)), moved);
      ASSERT_TRUE(moved.allFinite());
      for (const auto& part : surface.parts)
        EXPECT_NEAR(part_volume(surface, part, moved) / part_volume(surface, part, rest), 1, 0.01)
            << anatomy.muscles[part.muscle].name << " elbow " << elbow << " side " << side;
    }
}

TEST(MuscleSurface, NormalsAreUnitAndPointOutward) {
  const Anatomy anatomy = arm_anatomy();
  const MuscleSurface surface = make_muscle_surface(anatomy);
  const PosedAnatomy p = posed(anatomy, arm_pose(anatomy.skeleton, 30, 20, 10, 60, 30));
  PointsF positions, normals;
  update_muscle_surface(surface, p, positions, &normals);
  int inward = 0;
  for (int i = 0; i < surface.vertices(); ++i) {
    EXPECT_NEAR(normals.row(i).norm(), 1, 1e-5);
    const Vec3 from_center =
        positions.row(i).cast<double>().transpose() - p.slices[surface.slice[i]].center;
    inward += normals.row(i).cast<double>().dot(from_center.transpose()) < 0;
  }
  EXPECT_LT(inward, 0.01 * surface.vertices());
}

TEST(MuscleSurface, VerticesLieOnTheirSlicesAtTheirAngles) {
  const Anatomy anatomy = arm_anatomy();
  const MuscleSurface surface = make_muscle_surface(anatomy, {16, false});
  const auto slices = rest_slices(anatomy);
  Points positions;
  update_muscle_surface(surface, slices, positions);
  int on_rings = 0;
  for (int i = 0; i < surface.vertices(); ++i) {
    const Ellipse& e = slices[surface.slice[i]];
    const Vec3 at = positions.row(i).transpose();
    const double a = surface.angle[i];
    const Vec3 ring = e.center + e.axes.col(0) * e.radii.x() * std::cos(a) +
                      e.axes.col(1) * e.radii.y() * std::sin(a);
    on_rings += (at - ring).norm() < 1e-7;
  }
  EXPECT_EQ(on_rings, 16 * slice_count(anatomy));
}

TEST(MuscleSurface, SheetsOfUnequalSliceCountsAreClosedToo) {
  Anatomy anatomy = arm_anatomy();
  Muscle& sheet = anatomy.muscles.back();
  ASSERT_TRUE(sheet.sheet);
  const Anatomy coarse = arm_anatomy(1, 1, 8);
  sheet.strips[1] = coarse.muscles.back().strips[1];
  const MuscleSurface surface = make_muscle_surface(anatomy);
  const auto& part = surface.parts.back();
  EXPECT_TRUE(closed(surface.F.middleRows(part.face_begin, part.face_end - part.face_begin)));
  Points positions;
  update_muscle_surface(surface, rest_slices(anatomy), positions);
  EXPECT_NEAR(part_volume(surface, part, positions) / rest_volume(sheet), 1, 0.01);
  const TriMesh mesh = part_mesh(surface, part, positions);
  EXPECT_EQ(mesh.V.rows(), part.vertex_end - part.vertex_begin);
  EXPECT_EQ(mesh.F.maxCoeff() + 1, mesh.V.rows());
}

TEST(MuscleSurface, RowsBetweenSlicesLieOnCurvesThroughThem) {
  const Anatomy anatomy = arm_anatomy();
  const std::vector<Ellipse> slices = rest_slices(anatomy);
  const MuscleSurface coarse = make_muscle_surface(anatomy),
                      fine = make_muscle_surface(anatomy, {.rows_between = 1});
  Points coarse_at, fine_at;
  update_muscle_surface(coarse, slices, coarse_at);
  update_muscle_surface(fine, slices, fine_at);
  EXPECT_GT(fine.vertices(), 3 * coarse.vertices() / 2);
  for (std::size_t m = 0; m < fine.parts.size(); ++m) {
    const MuscleSurface::Part &part = fine.parts[m], &other = coarse.parts[m];
    EXPECT_TRUE(closed(fine.F.middleRows(part.face_begin, part.face_end - part.face_begin))) << m;
    EXPECT_NEAR(part_volume(fine, part, fine_at) / part_volume(coarse, other, coarse_at), 1, 0.03);
    for (int v = other.vertex_begin; v < other.vertex_end; ++v)  // each of the slices is kept
      EXPECT_LT(
          (fine_at.middleRows(part.vertex_begin, part.vertex_end - part.vertex_begin).rowwise() -
           coarse_at.row(v))
              .rowwise()
              .norm()
              .minCoeff(),
          1e-9)
          << m << " " << v;
  }
}

TEST(MuscleSurface, RefusesAbsurdOptions) {
  EXPECT_THROW(make_muscle_surface(arm_anatomy(), {.rows_between = -1}), std::invalid_argument);
  EXPECT_THROW(make_muscle_surface(arm_anatomy(), {7, true}), std::invalid_argument);
}
