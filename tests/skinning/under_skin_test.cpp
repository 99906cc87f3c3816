// Laws of muscles beneath the skin: at rest nothing moves; where the skin is drawn in, nothing
// stays outside and bellies keep their volume; more of it moves everything a little more.
#include "skinning/muscle_collision/push_muscles.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "anatomy/queries/nearest_surface.h"
#include "tests/anatomy/strips.h"
#include "tests/skinning/arm.h"
#include "tests/skinning/compiled_arm.h"

namespace ecorche {
namespace {

// A spindle of 30 mm in a tube of 45 mm about it, 0.4 m long.
struct Limb {
  Anatomy anatomy;
  TriMesh skin;
  MuscleModel muscles;
  PosedAnatomy rest;
  MuscleCollision collision;

  explicit Limb(double end_radius = 0.006) {
    anatomy.skeleton = testing::arm_skeleton();
    Muscle muscle;
    muscle.name = "spindle";
    muscle.strips.push_back(
        make_strip({testing::on(0, {0.01, 1.0, 0}), testing::on(0, {0.01, 1.15, 0.002}),
                    testing::on(0, {0.01, 1.3, 0})},
                   testing::spindle(15, 0.03, end_radius, 0.1, 0.9, Vec3::UnitX())));
    muscle.strips[0].belly_begin = 0.1;
    muscle.strips[0].belly_end = 0.9;
    anatomy.muscles.push_back(muscle);
    std::vector<Vec2> profile;
    for (int k = 0; k <= 40; ++k) profile.emplace_back(0.01 * k, k == 0 || k == 40 ? 0.03 : 0.045);
    skin = test::lathe(Vec3(0, 0.95, 0), Vec3::UnitY(), profile, 32);
    muscles = make_muscle_model(anatomy);
    pose_anatomy(muscles.posing, anatomy.skeleton, rest_pose(anatomy.skeleton), rest);
    collision = make_muscle_collision(anatomy, rest, skin);
  }

  // The skin drawn in on its +x side by `depth` at a height, the middle's.
  SkinFrame drawn_in(double depth, double height = 1.15) const {
    SkinFrame frame;
    for (Eigen::Index v = 0; v < skin.V.rows(); ++v) {
      Vec3 p = skin.V.row(v);
      const double along = (p.y() - height) / 0.08;
      if (p.x() > 0) p.x() -= depth * std::exp(-along * along) * p.x() / 0.045;
      for (int k = 0; k < 3; ++k) frame.positions.push_back(float(p[k]));
      frame.positions.push_back(1);
    }
    frame.normals.resize(frame.positions.size());
    vertex_normals(frame.positions, std::span(skin.F.data(), std::size_t(skin.F.size())),
                   frame.normals);
    return frame;
  }

  // How far the drawn muscle comes out, m: by winding numbers and distances, knows nothing of
  // sections.
  double furthest_out(const PosedAnatomy& posed, const SkinFrame& frame) const {
    const MuscleSurface surface = make_muscle_surface(anatomy);
    Points drawn;
    update_muscle_surface(surface, posed, drawn);
    TriMesh shape{{}, skin.F};
    to_points(frame, shape.V);
    const std::vector<int> winding = winding_numbers(shape, drawn);
    const NearestSurface surface_of_skin(shape);
    double most = 0;
    for (std::size_t i = 0; i < winding.size(); ++i)
      if (winding[i] == 0) most = std::max(most, surface_of_skin.nearest(drawn.row(i)).distance);
    return most;
  }
};

// All memory of one collision.
struct Memory {
  RelaxedSkin skin;
  SkinLift lift;
  LiftWorkspace lifting;
  PushWorkspace push;
};

void keep_under_skin(const Limb& limb, SkinFrame& frame, PosedAnatomy& posed, Memory& memory) {
  RelaxedSkin& skin = memory.skin;
  skin.positions = frame.positions;
  skin.normals = frame.normals;
  skin.openness.assign(frame.positions.size() / 4, 1.0f);
  skin.liftable = skin.openness;
  lift_skin_over_muscles(limb.collision, posed.slices, skin, memory.lift, memory.lifting);
  if (memory.lift.lifted) {
    vertex_normals(skin.positions, std::span(limb.skin.F.data(), std::size_t(limb.skin.F.size())),
                   skin.normals);
    push_muscles_below_skin(limb.collision, limb.muscles, skin, memory.lift, posed, memory.push);
  }
  frame.positions = skin.positions;
  frame.normals = skin.normals;
}

TEST(UnderSkin, AtRestNothingMoves) {
  const Limb limb;
  SkinFrame frame = limb.drawn_in(0);
  const SkinFrame before = frame;
  PosedAnatomy posed = limb.rest;
  Memory memory;
  keep_under_skin(limb, frame, posed, memory);
  EXPECT_EQ(frame.positions, before.positions);
  EXPECT_EQ(std::memcmp(posed.slices.data(), limb.rest.slices.data(),
                        posed.slices.size() * sizeof(Ellipse)),
            0);
}

TEST(UnderSkin, WhatComesOutGoesBackAndKeepsItsVolume) {
  const Limb limb;
  const SliceRange range = slice_ranges(limb.anatomy)[0];
  for (const double depth : {0.012, 0.02, 0.03}) {
    SkinFrame frame = limb.drawn_in(depth);
    const SkinFrame drawn = frame;
    PosedAnatomy posed = limb.rest;
    Memory memory;
    const double before = limb.furthest_out(posed, frame);
    keep_under_skin(limb, frame, posed, memory);
    EXPECT_GT(before, 0.003);
    EXPECT_LT(limb.furthest_out(posed, frame), 0.15 * before) << depth << " " << before;
    EXPECT_NEAR(strip_volume(posed, range) / strip_volume(limb.rest, range), 1, 1e-9);
    double risen = 0;
    for (std::size_t k = 0; k < frame.positions.size(); ++k)
      risen = std::max(risen, std::abs(double(frame.positions[k] - drawn.positions[k])));
    EXPECT_GT(risen, 0);
    EXPECT_LT(risen, depth) << "the skin comes back by no more than it was drawn in";
  }
}

TEST(UnderSkin, BonesHoldEnds) {
  const auto end_moves_by = [](const Limb& limb) {
    SkinFrame frame = limb.drawn_in(0.05, 1.02);
    PosedAnatomy posed = limb.rest;
    Memory memory;
    keep_under_skin(limb, frame, posed, memory);
    return (posed.slices[0].center - limb.rest.slices[0].center).norm();
  };
  Limb limb(0.02);
  EXPECT_GT(end_moves_by(limb), 0.002) << "an end in fascia";
  limb.anatomy.muscles[0].origin_bone = "scapula";
  limb.collision = make_muscle_collision(limb.anatomy, limb.rest, limb.skin);
  EXPECT_EQ(end_moves_by(limb), 0);
}

TEST(UnderSkin, MovesSteadilyWithTheSkin) {
  const Limb limb;
  PosedAnatomy before, now;
  Memory memory;
  constexpr double kStep = 1e-4;
  double most = 0;
  for (double depth = 0; depth < 0.03; depth += kStep) {
    SkinFrame frame = limb.drawn_in(depth);
    now = limb.rest;
    keep_under_skin(limb, frame, now, memory);
    if (depth > 0)
      for (std::size_t k = 0; k < now.slices.size(); ++k)
        for (std::size_t i = 0; i < kOutlinePoints; ++i) {
          const auto length = [&](const PosedAnatomy& p) {
            return double(p.slices[k].outline[i]) * p.slices[k].radii.mean();
          };
          most = std::max({most, std::abs(length(now) - length(before)),
                           (now.slices[k].center - before.slices[k].center).norm()});
        }
    std::swap(before, now);
  }
  EXPECT_LT(most, 1e-3) << "m, while the skin moves by a tenth of a millimetre";
}

TEST(UnderSkin, SameBytesAtAnyNumberOfThreads) {
  const Limb limb;
  std::vector<float> skins[2];
  PosedAnatomy posed[2];
  for (int i = 0; i < 2; ++i) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, i == 0 ? 1 : 2);
    SkinFrame frame = limb.drawn_in(0.02);
    posed[i] = limb.rest;
    Memory memory;
    keep_under_skin(limb, frame, posed[i], memory);
    skins[i] = frame.positions;
  }
  EXPECT_EQ(skins[0], skins[1]);
  EXPECT_EQ(std::memcmp(posed[0].slices.data(), posed[1].slices.data(),
                        posed[0].slices.size() * sizeof(Ellipse)),
            0);
}

double volume_of(const Triangles& F, const SkinFrame& frame) {
  Points V;
  to_points(frame, V);
  double six = 0;
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    six += V.row(F(f, 0)).dot(V.row(F(f, 1)).cross(V.row(F(f, 2))));
  return six / 6;
}

TEST(UnderSkin, TheSkinKeepsItsVolumeAndRisesNotWhereItIsClosed) {
  const test::Arm arm = test::make_arm();
  const CharacterModel model = test::compile_figure(arm.anatomy, arm.skin);
  CharacterModel without = model;
  without.skin.collision = {};
  PosedAnatomy posed;
  Pose pose = rest_pose(arm.anatomy.skeleton);
  pose.rotations[3] = Quat(Eigen::AngleAxisd(-0.5, Vec3::UnitX()));
  pose_anatomy(model.muscles.posing, arm.anatomy.skeleton, pose, posed);
  CharacterState settled(without);
  settled.posed = posed;
  evaluate_posed_skin(without.skin, {}, settled);
  for (Ellipse& slice : posed.slices) slice.center.z() += 0.015;
  RelaxedSkin closed = settled.relaxed;
  closed.liftable.assign(closed.positions.size() / 4, 0.0f);
  SkinLift lift;
  LiftWorkspace lifting;
  lift_skin_over_muscles(model.skin.collision, posed.slices, closed, lift, lifting);
  EXPECT_TRUE(lift.lifted) << "the muscle comes out";
  EXPECT_EQ(closed.positions, settled.relaxed.positions);
  const SkinFrame still = test::skin_over(without, posed),  // handles know the moved muscle
      over = test::skin_over(model, posed);
  double risen = 0;
  for (std::size_t k = 0; k < over.positions.size(); ++k)
    risen = std::max(risen, std::abs(double(over.positions[k] - still.positions[k])));
  EXPECT_GT(risen, 1e-3);
  EXPECT_NEAR(volume_of(arm.skin.F, over) / volume_of(arm.skin.F, still), 1, 5e-4);
}

TEST(UnderSkin, RefusesWhatBelongsToAnother) {
  const Limb limb;
  SkinFrame frame = limb.drawn_in(0);
  frame.positions.resize(8);
  PosedAnatomy posed = limb.rest;
  Memory memory;
  EXPECT_THROW(keep_under_skin(limb, frame, posed, memory), std::invalid_argument);
}

TEST(UnderSkin, MusclesGiveWayOnlyToASkinThatWasLiftedOverThem) {
  const test::Arm arm = test::make_arm();
  const CharacterModel model = test::compile_figure(arm.anatomy, arm.skin);
  const MuscleCollision& collision = model.skin.collision;
  CharacterState state(model);
  pose_anatomy(model.muscles.posing, arm.anatomy.skeleton, rest_pose(arm.anatomy.skeleton),
               state.posed);
  for (Ellipse& slice : state.posed.slices) slice.center.z() += 0.015;
  const PosedAnatomy before = state.posed;
  const auto same = [&] {
    return std::memcmp(state.posed.slices.data(), before.slices.data(),
                       before.slices.size() * sizeof(Ellipse)) == 0;
  };
  const auto push = [&] {
    push_muscles_below_skin(collision, model.muscles, state.relaxed, state.lift, state.posed,
                            state.push);
  };
  EXPECT_THROW(push(), std::invalid_argument);
  CharacterModel without = model;
  without.skin.collision = {};
  evaluate_posed_skin(without.skin, {}, state);
  EXPECT_THROW(push(), std::invalid_argument);
  evaluate_posed_skin(model.skin, {}, state);
  EXPECT_TRUE(same()) << "the skin alone leaves them";
  push();
  EXPECT_FALSE(same());
}

// The muscles of a frame are those of its own skin, whatever other states have done in between.
TEST(UnderSkin, AFrameDependsOnItsOwnStateAlone) {
  const test::Arm arm = test::make_arm();
  const CharacterModel model = test::compile_figure(arm.anatomy, arm.skin);
  Pose bent = rest_pose(arm.anatomy.skeleton);
  bent.rotations[3] = Quat(Eigen::AngleAxisd(-2.2, Vec3::UnitX()));
  CharacterState one(model), other(model);
  evaluate(model, bent, {}, one);
  evaluate(model, rest_pose(arm.anatomy.skeleton), {}, other);
  CharacterState copy = other;
  evaluate(model, bent, {}, copy);
  EXPECT_EQ(copy.skin.positions, one.skin.positions);
  EXPECT_EQ(std::memcmp(copy.posed.slices.data(), one.posed.slices.data(),
                        one.posed.slices.size() * sizeof(Ellipse)),
            0);
}

}  // namespace
}  // namespace ecorche
