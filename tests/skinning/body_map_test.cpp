// Laws of the map of a body's inside: the rest pose stays, a body that turns as a whole keeps its
// shape, neighbours stay neighbours in a bend, muscles go in where the skin does, limbs that touch
// are apart.
#include "skinning/interior/body_map.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cstring>

#include "anatomy/errors.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/muscles/action_line.h"
#include "tests/skinning/arm.h"
#include "tests/skinning/compiled_arm.h"

namespace ecorche {
namespace {

constexpr int kSections = 13;

// An arm with two muscles over its elbow that touch along their sides.
CharacterModel two_muscles(bool bones = true) {
  test::Arm arm = test::make_arm();
  Muscle& biceps = arm.anatomy.muscles.front();
  Muscle twin = biceps;
  twin.name = "twin_l";
  for (const auto& [muscle, side] : {std::pair(&biceps, -1.0), std::pair(&twin, 1.0)})
    for (PathPoint& point : muscle->strips[0].path) point.rest.x() += 0.005 * side;
  arm.anatomy.muscles.push_back(twin);
  if (!bones) arm.anatomy.bones.clear();
  return test::compile_figure(arm.anatomy, arm.skin, {.muscles = MuscleMotion::map});
}

Pose bent(const CharacterModel& model, double angle) {
  Pose pose = rest_pose(model.character.anatomy.skeleton);
  pose.rotations[3] = Quat(Eigen::AngleAxisd(-angle, Vec3::UnitX()));
  return pose;
}

TEST(BodyMap, LeavesTheRestPose) {
  const CharacterModel model = two_muscles();
  CharacterState state(model);
  evaluate(model, rest_pose(model.character.anatomy.skeleton), {}, state);
  const std::vector<Ellipse> rest = rest_slices(model.character.anatomy);
  for (std::size_t k = 0; k < rest.size(); ++k) {
    EXPECT_LT((state.posed.slices[k].center - rest[k].center).norm(), 2e-5) << k;
    EXPECT_LT((state.posed.slices[k].radii - rest[k].radii).norm(), 2e-5) << k;
    EXPECT_LT((state.posed.slices[k].axes - rest[k].axes).norm(), 5e-3) << k;
  }
}

TEST(BodyMap, TurnsABodyAsAWhole) {
  const CharacterModel model = two_muscles();
  CharacterState state(model);
  Pose pose = rest_pose(model.character.anatomy.skeleton);
  const Quat turn(Eigen::AngleAxisd(2.5, Vec3(1, 2, -1).normalized()));
  pose.rotations[0] = turn;
  pose.root += Vec3(3, 0, -1);
  evaluate(model, pose, {}, state);
  const std::vector<Ellipse> rest = rest_slices(model.character.anatomy);
  for (std::size_t k = 1; k < rest.size(); ++k)
    EXPECT_LT((state.posed.slices[k].center - state.posed.slices[0].center -
               turn * (rest[k].center - rest[0].center))
                  .norm(),
              5e-5)
        << k;
}

TEST(BodyMap, KeepsNeighboursTogetherInABend) {
  const CharacterModel model = two_muscles();
  CharacterState state(model);
  const std::vector<Ellipse> rest = rest_slices(model.character.anatomy);
  for (const double angle : {0.7, 1.4, 2.1}) {
    evaluate(model, bent(model, angle), {}, state);
    for (int k = 0; k < kSections; ++k) {
      const Ellipse &one = state.posed.slices[k], &other = state.posed.slices[k + kSections];
      const double before = (rest[k + kSections].center - rest[k].center).norm();
      EXPECT_LT((other.center - one.center).norm(), before + 0.004) << angle << " " << k;
      // side by side, as they lay
      EXPECT_GT((other.center - one.center).normalized().x(), 0.8) << angle << " " << k;
    }
    // no section goes back past the one before
    for (const int first : {0, kSections})
      for (int k = first; k + 2 < first + kSections; ++k)
        EXPECT_GT((state.posed.slices[k + 1].center - state.posed.slices[k].center)
                      .normalized()
                      .dot((state.posed.slices[k + 2].center - state.posed.slices[k + 1].center)
                               .normalized()),
                  -0.2)
            << angle << " " << k;
  }
}

TEST(BodyMap, HoldsEndsOnTheirBones) {
  const CharacterModel model = two_muscles();
  const Anatomy& anatomy = model.character.anatomy;
  CharacterState rest(model), state(model);
  evaluate(model, rest_pose(anatomy.skeleton), {}, rest);
  for (const double angle : {0.7, 1.4, 2.1}) {
    evaluate(model, bent(model, angle), {}, state);
    for (const SliceRange& strip : slice_ranges(anatomy)) {
      const Muscle& muscle = anatomy.muscles[strip.muscle];
      ASSERT_FALSE(muscle.origin_bone.empty());
      const std::vector<PathPoint>& path = muscle.strips[strip.strip].path;
      for (const auto& [slice, joint] : {std::pair(strip.begin, path.front().joints[0]),
                                         std::pair(strip.end - 1, path.back().joints[0])}) {
        const Vec3 held = state.posed.X_WJ[joint] * rest.posed.X_WJ[joint].inverse() *
                          rest.posed.slices[slice].center;
        EXPECT_LT((state.posed.slices[slice].center - held).norm(), 1e-3) << angle << " " << slice;
      }
    }
  }
}

// How far sections of a muscle behind the forearm lie, 1 to 6 cm below a bent elbow, from where the
// forearm alone brings them. Its line comes from the upper arm, straight at rest. `tied`: to the
// forearm next to the elbow, too.
double off_forearm(bool tied, bool sheet, const char* layer = "superficial") {
  test::Arm arm = test::make_arm();
  const Vec3 elbow(0.2, 1.1, 0), from = elbow + Vec3(0, 0.03, -0.02),
                                 to = elbow + Vec3(0, -0.11, -0.02);
  Muscle& muscle = arm.anatomy.muscles.front();
  muscle.sheet = sheet;
  muscle.layer = layer;
  std::vector<PathPoint>& path = muscle.strips[0].path;
  path = {{from, {2, -1}, 1}, {to, {3, -1}, 1}};
  if (tied) path.insert(path.begin() + 1, {elbow + Vec3(0, -0.01, -0.02), {3, -1}, 1});
  for (Slice& slice : muscle.strips[0].slices) slice.radii = {0.008, 0.006};
  const CharacterModel model =
      test::compile_figure(arm.anatomy, arm.skin, {.muscles = MuscleMotion::map});
  CharacterState rest(model), state(model);
  evaluate(model, rest_pose(arm.anatomy.skeleton), {}, rest);
  evaluate(model, bent(model, 2.1), {}, state);
  const Transform motion = state.posed.X_WJ[3] * rest.posed.X_WJ[3].inverse();
  double sum = 0;
  for (std::size_t k = 0; k < rest.posed.slices.size(); ++k) {
    const Vec3 at = rest.posed.slices[k].center;
    if (at.y() < elbow.y() - 0.01 && at.y() > elbow.y() - 0.06)
      sum += (state.posed.slices[k].center - motion * at).norm();
  }
  return sum;
}

TEST(BodyMap, CarriesABellyByTheJointsThatItsLinePassesThere) {
  const double tied = off_forearm(true, false), loose = off_forearm(false, false);
  EXPECT_LT(tied, 0.85 * loose) << loose;
  EXPECT_GT(off_forearm(true, true), 0.9 * loose) << "sheets stay with those beside them";
}

TEST(BodyMap, BedsADeepMuscleOnTheBoneThatItLiesAlong) {
  const double on_top = off_forearm(true, false), bedded = off_forearm(true, false, "deep");
  EXPECT_LT(bedded, 0.65 * on_top);
  EXPECT_NEAR(off_forearm(false, false, "deep"), off_forearm(false, false), 1e-9)
      << "its line does not say that it lies there";
}

// A muscle over the forearm whose line is held by the upper arm.
TEST(BodyMap, SectionsGlideWhereTheirLineDoes) {
  const auto forearm_share = [](int placing_joint) {
    test::Arm arm = test::make_arm();
    Muscle& muscle = arm.anatomy.muscles.front();
    const Vec3 elbow(0.2, 1.1, 0);
    muscle.strips[0].path = {{elbow + Vec3(0, 0.05, -0.02), {2, -1}, 1},
                             {elbow + Vec3(0, -0.06, -0.02), {2, 3}, 0.75, placing_joint},
                             {elbow + Vec3(0, -0.16, -0.02), {3, -1}, 1}};
    const CharacterModel model =
        test::compile_figure(arm.anatomy, arm.skin, {.muscles = MuscleMotion::map});
    const MapPoints& centers = model.interior->centers;
    std::size_t nearest = 0;
    for (std::size_t k = 0; k < centers.size(); ++k) {
      const auto height = [&](std::size_t i) {
        return std::abs(double(centers.heads[i].rest.y()) - (elbow.y() - 0.06));
      };
      if (height(k) < height(nearest)) nearest = k;
    }
    double share = 0;
    for (int s = centers.heads[nearest].joints; s < centers.heads[nearest].skin; ++s)
      if (centers.shares[std::size_t(s)].source == 3)
        share += double(centers.shares[std::size_t(s)].weight);
    return share;
  };
  EXPECT_GT(forearm_share(-1), 0.9);
  EXPECT_NEAR(forearm_share(3), 0.25, 0.15);
}

// A lobe beside the forearm that no bone reaches, as a lip is parted by the mouth's slit.
TEST(BodyMap, WhatNoBoneReachesGoesWithTheNearest) {
  test::Arm arm = test::make_arm();
  const Vec3 elbow(0.2, 1.1, 0), from = elbow + Vec3(0.1, -0.2, 0),
                                 to = elbow + Vec3(0.1, -0.14, 0);
  const TriMesh lobe = test::capsule(from, to, 0.03, 24);
  arm.skin = join_meshes({&arm.skin, &lobe});
  Muscle muscle = arm.anatomy.muscles.front();
  muscle.name = "lobe_l";
  muscle.origin_bone = muscle.insertion_bone = "ulna_l";
  muscle.strips[0].path = {{from, {3, -1}, 1}, {0.5 * (from + to), {3, -1}, 1}, {to, {3, -1}, 1}};
  for (Slice& slice : muscle.strips[0].slices) slice.radii = {0.01, 0.01};
  arm.anatomy.muscles.push_back(muscle);
  const CharacterModel model =
      test::compile_figure(arm.anatomy, arm.skin, {.muscles = MuscleMotion::map});
  CharacterState state(model);
  evaluate_skin(model, bent(model, 1.5), {}, state);
  // The skin as it lies then about the lobe, which goes with the forearm.
  const Quat turn(Eigen::AngleAxisd(-1.5, Vec3::UnitX()));
  const Points normals = vertex_normals(arm.skin);
  const std::vector<int>& order = model.skin.base_blend->mesh.order;
  std::vector<float> positions = state.relaxed.positions, outwards = state.relaxed.normals;
  for (std::size_t s = 0; s < positions.size() / 4; ++s) {
    const int v = order.empty() ? int(s) : order[s];
    if (v < arm.skin.V.rows() - lobe.V.rows()) continue;
    const Vec3 p = elbow + turn * (arm.skin.V.row(v).transpose() - elbow),
               n = turn * Vec3(normals.row(v));
    for (int k = 0; k < 3; ++k)
      positions[4 * s + k] = float(p[k]), outwards[4 * s + k] = float(n[k]);
  }
  BodyMapWorkspace workspace;
  carry_muscles(*model.interior, positions, outwards, state.posed, workspace);
  const std::vector<Ellipse> rest = rest_slices(model.character.anatomy);
  for (std::size_t k = kSections; k < rest.size(); ++k)
    EXPECT_LT((state.posed.slices[k].center - elbow - turn * (rest[k].center - elbow)).norm(), 0.01)
        << k;
}

TEST(BodyMap, GoesInWhereTheSkinDoesAndNotOut) {
  const CharacterModel model = two_muscles();
  CharacterState state(model);
  const Pose rest = rest_pose(model.character.anatomy.skeleton);
  evaluate(model, rest, {}, state);
  const std::vector<Ellipse> before = state.posed.slices;
  for (const double depth : {0.006, -0.006}) {
    std::vector<float> positions = state.relaxed.positions;
    for (std::size_t v = 0; v < positions.size(); v += 4)
      for (std::size_t k = 0; k < 3; ++k)
        positions[v + k] -= float(depth) * state.relaxed.normals[v + k];
    pose_muscles(model.muscles, model.character.anatomy.skeleton, rest, state.posed, state.contact);
    carry_muscles(*model.interior, positions, state.relaxed.normals, state.posed, state.carrying);
    const double inward = before[6].center.z() - state.posed.slices[6].center.z();
    if (depth > 0) {
      EXPECT_GT(inward, 0.001);
      EXPECT_LT(inward, depth);
    } else {
      EXPECT_NEAR(inward, 0, 1e-4);
    }
  }
}

TEST(BodyMap, KeepsTheVolumesOfBellies) {
  const CharacterModel model = two_muscles();
  CharacterState state(model);
  evaluate(model, rest_pose(model.character.anatomy.skeleton), {}, state);
  const std::vector<SliceRange> strips = slice_ranges(model.character.anatomy);
  std::vector<double> before;
  for (const SliceRange& strip : strips) before.push_back(strip_volume(state.posed, strip));
  for (const double angle : {0.7, 1.4, 2.1}) {
    evaluate(model, bent(model, angle), {}, state);
    for (std::size_t s = 0; s < strips.size(); ++s)
      EXPECT_NEAR(strip_volume(state.posed, strips[s]) / before[s], 1, 1e-4) << angle << " " << s;
  }
}

TEST(BodyMap, CarriesTheShapeThatEffortGives) {
  CharacterModel model = two_muscles();
  for (Muscle& muscle : model.character.anatomy.muscles) muscle.tense_thickness = 1.3;
  model.muscles = make_muscle_model(model.character.anatomy);
  CharacterState relaxed(model), tense(model);
  const Pose rest = rest_pose(model.character.anatomy.skeleton);
  evaluate(model, rest, {}, relaxed);
  const std::vector<double> effort(2, 1.0);
  evaluate(model, rest, {effort}, tense);
  const int middle = kSections / 2;
  EXPECT_NEAR(tense.posed.slices[middle].radii.y() / relaxed.posed.slices[middle].radii.y(), 1.3,
              0.04);
}

TEST(BodyMap, LeansNoSectionAlongItsLine) {
  const CharacterModel model = two_muscles();
  CharacterState state(model);
  for (const double angle : {1.4, 2.1, 2.5}) {
    evaluate(model, bent(model, angle), {}, state);
    for (const int first : {0, kSections})
      for (int k = first + 1; k + 1 < first + kSections; ++k) {
        const Ellipse& section = state.posed.slices[k];
        const Vec3 line = state.posed.slices[k + 1].center - state.posed.slices[k - 1].center;
        const Vec3 normal = section.axes.col(0).cross(section.axes.col(1));
        EXPECT_GT(normal.dot(line.normalized()), 0.3) << angle << " " << k;
      }
  }
}

TEST(BodyMap, TurnsSectionsIntoOneAnotherWithoutCorners) {
  const CharacterModel model = two_muscles();
  CharacterState state(model);
  evaluate(model, bent(model, 2.1), {}, state);
  double sharpest = 0;
  for (const int first : {0, kSections})
    for (int k = first + 1; k + 1 < first + kSections; ++k) {
      const auto turn = [&](int at) {
        return state.posed.slices[at].axes.col(1).dot(state.posed.slices[at + 1].axes.col(1));
      };
      sharpest = std::max(sharpest, std::acos(std::min(1.0, turn(k))));
    }
  EXPECT_LT(sharpest, 0.75) << "rad";
}

TEST(BodyMap, IsTheSameAtAnyNumberOfThreads) {
  const CharacterModel model = two_muscles();
  std::vector<Ellipse> first;
  for (const int threads : {1, 2, 4}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            std::size_t(threads));
    CharacterState state(two_muscles());
    evaluate(model, bent(model, 1.2), {}, state);
    if (first.empty()) first = state.posed.slices;
    for (std::size_t k = 0; k < first.size(); ++k)
      EXPECT_EQ(
          std::memcmp(first[k].center.data(), state.posed.slices[k].center.data(), sizeof(Vec3)), 0)
          << k;
  }
}

TEST(BodyMap, MadeOfTheOneBeforeIsAsMadeAnew) {
  const CharacterModel before = two_muscles();
  Anatomy anatomy = before.character.anatomy;
  Muscle third = anatomy.muscles.front();  // comes first: sections have other numbers
  third.name = "third_l";
  for (PathPoint& point : third.strips[0].path) point.rest.z() -= 0.012;
  anatomy.muscles.insert(anatomy.muscles.begin(), third);
  for (Slice& slice : anatomy.muscles.back().strips[0].slices) slice.radii *= 0.9;
  const TriMesh& skin = before.character.body.skin;
  const CharacterModel whole = test::compile_figure(anatomy, skin, {.muscles = MuscleMotion::map}),
                       again = test::compile_figure(
                           anatomy, skin, {.muscles = MuscleMotion::map, .before = &before});
  EXPECT_EQ(again.interior->weights, before.interior->weights);
  EXPECT_EQ(again.skin.elastic, before.skin.elastic);
  CharacterState one(whole), other(again);
  evaluate(whole, bent(whole, 1.2), {}, one);
  evaluate(again, bent(again, 1.2), {}, other);
  ASSERT_EQ(one.posed.slices.size(), std::size_t(3 * kSections));
  for (std::size_t k = 0; k < one.posed.slices.size(); ++k) {
    EXPECT_LT((one.posed.slices[k].center - other.posed.slices[k].center).norm(), 2e-6) << k;
    EXPECT_LT((one.posed.slices[k].radii - other.posed.slices[k].radii).norm(), 2e-6) << k;
  }
  for (std::size_t k = 0; k < one.skin.positions.size(); ++k)
    ASSERT_NEAR(one.skin.positions[k], other.skin.positions[k], 2e-6f) << k;
}

TEST(BodyMap, RefusesASkinWithoutBones) { EXPECT_THROW(two_muscles(false), UnfitError); }

TEST(BodyLattice, HasNoLinksAcrossTheSkin) {
  // two closed limbs of 30 mm, 4 mm apart
  TriMesh skin = test::capsule({0, 0, 0}, {0, 0.3, 0}, 0.03);
  const TriMesh other = test::capsule({0.064, 0, 0}, {0.064, 0.3, 0}, 0.03);
  const Eigen::Index vertices = skin.V.rows(), faces = skin.F.rows();
  skin.V.conservativeResize(2 * vertices, 3);
  skin.F.conservativeResize(2 * faces, 3);
  skin.V.bottomRows(vertices) = other.V;
  skin.F.bottomRows(faces) = (other.F.array() + int(vertices)).matrix();
  const BodyLattice lattice = make_body_lattice(SkinRays(skin), 0.008);
  // volume of the capsules, to the coarse cells' share
  const double volume = lattice.nodes() * std::pow(0.008, 3);
  EXPECT_NEAR(volume, 2 * 0.00096, 0.0002);
  for (int i = 0; i < lattice.nodes(); ++i)
    for (const int k : lattice.links[i]) {
      if (k < 0) continue;
      EXPECT_EQ(lattice.points[i].x() < 0.032, lattice.points[k].x() < 0.032);
    }
}

// A block of cells about a bone of one layer, squeezed across.
struct Block {
  Block() {
    const TriMesh skin = test::capsule({0, 0, 0}, {0, 0.3, 0}, 0.06);
    lattice = make_body_lattice(SkinRays(skin), 0.012);
    for (const Vec3& p : lattice.points) bone.push_back(std::abs(p.z()) < 0.007);
    squeezed = lattice.points;
    for (std::size_t i = 0; i < squeezed.size(); ++i)
      if (!bone[i]) squeezed[i].y() = 0.15 + (squeezed[i].y() - 0.15) * 0.8;
    turns.assign(squeezed.size(), Mat3::Identity());
  }
  // Mean departure of volumes from rest, of cells whose neighbours are no bone.
  double missed(std::span<const Vec3> at) const {
    double sum = 0;
    int count = 0;
    for (int i = 0; i < lattice.nodes(); ++i) {
      const bool apart = std::ranges::all_of(lattice.links[i],
                                             [&](int other) { return other >= 0 && !bone[other]; });
      if (bone[i] || !apart) continue;
      sum += std::abs(cell_volume(lattice, at, turns[i], i) - 1);
      ++count;
    }
    return sum / count;
  }

  BodyLattice lattice;
  std::vector<char> bone;
  std::vector<Vec3> squeezed;
  std::vector<Mat3> turns;
};

TEST(PressureProjection, BringsVolumesBackAndLeavesBone) {
  const Block block;
  std::vector<Vec3> at = block.squeezed;
  const PressureTable table =
      make_pressure_table(block.lattice, block.bone, std::vector<double>(at.size(), 1.0));
  PressureWorkspace workspace;
  restore_cell_volumes(table, block.turns, 3, at, workspace);
  EXPECT_GT(block.missed(block.squeezed), 0.15);
  EXPECT_LT(block.missed(at), 0.2 * block.missed(block.squeezed));
  for (std::size_t i = 0; i < at.size(); ++i)
    if (block.bone[i]) {
      EXPECT_EQ(at[i], block.squeezed[i]) << i;
    }
}

TEST(PressureProjection, LeavesWhatKeepsNoVolumeAndWhatHasIt) {
  const Block block;
  PressureWorkspace workspace;
  std::vector<Vec3> at = block.squeezed;
  restore_cell_volumes(
      make_pressure_table(block.lattice, block.bone, std::vector<double>(at.size(), 0.0)),
      block.turns, 2, at, workspace);
  EXPECT_EQ(at, block.squeezed);
  at = block.lattice.points;
  restore_cell_volumes(
      make_pressure_table(block.lattice, block.bone, std::vector<double>(at.size(), 1.0)),
      block.turns, 2, at, workspace);
  for (std::size_t i = 0; i < at.size(); ++i)
    EXPECT_LT((at[i] - block.lattice.points[i]).norm(), 1e-12) << i;
}

TEST(HarmonicWeights, AreLinearAlongARod) {
  const TriMesh skin = test::capsule({0, 0, 0}, {0, 0.4, 0}, 0.03);
  const SkinRays rays(skin);
  const BodyLattice lattice = make_body_lattice(rays, 0.01);
  std::vector<SourceWeights> fixed(lattice.nodes());
  for (int i = 0; i < lattice.nodes(); ++i) {
    const double y = lattice.points[i].y();
    if (y > 0.05 && y < 0.35) continue;
    fixed[i].source[0] = y < 0.2 ? 0 : 1;
    fixed[i].weight[0] = 1;
    fixed[i].count = 1;
  }
  const auto weights = harmonic_weights(lattice, fixed, 2, {}, 2000);
  for (const double y : {0.1, 0.2, 0.3}) {
    const SourceWeights at = mix_weights(lattice_shares(lattice, rays, {0.004, y, 0.002}), weights);
    double second = 0, sum = 0;
    for (int k = 0; k < at.count; ++k) {
      sum += double(at.weight[k]);
      if (at.source[k] == 1) second = double(at.weight[k]);
    }
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_NEAR(second, (y - 0.045) / 0.31, 0.03) << y;
  }
}

}  // namespace
}  // namespace ecorche
