// A frame writes into memory that it has had before: nothing is allocated once the first frames
// have sized it.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <numbers>

#include "anatomy/geometry/subdivide.h"
#include "anatomy/posing/pose_anatomy.h"
#include "skinning/muscle_collision/push_muscles.h"
#include "tests/skinning/arm.h"
#include "tests/skinning/compiled_arm.h"

namespace {

std::atomic<long> allocations{0};

void* counted(std::size_t size, std::size_t alignment) {
  ++allocations;
  void* memory = alignment > alignof(std::max_align_t)
                     ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
                     : std::malloc(size > 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return counted(size, 0); }
void* operator new[](std::size_t size) { return counted(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, std::size_t(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return counted(size, std::size_t(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace ecorche {
namespace {

// Bends the elbow ever further, up to where forearm and upper arm meet, and counts what the frames
// after the first few allocate.
long allocated(const CharacterModel& model) {
  const Skeleton& skeleton = model.character.anatomy.skeleton;
  CharacterState state(model);
  Pose pose = rest_pose(skeleton);
  const auto play = [&](double angle) {
    pose.rotations[3] = Quat(Eigen::AngleAxisd(-angle, Vec3::UnitX()));
    pose_anatomy(model.muscles.posing, skeleton, pose, state.posed);
    for (Ellipse& slice : state.posed.slices) slice.center.z() += 0.02;  // the muscle comes out
    evaluate_posed_skin(model.skin, {}, state);
    push_muscles_below_skin(model.skin.collision, model.muscles, state.relaxed, state.lift,
                            state.posed, state.push);
  };
  for (const double angle : {0.0, 20.0, 150.0, 150.0, 150.0}) play(angle * kDegree);
  const long before = allocations;
  for (int k = 0; k < 20; ++k) play(150 * kDegree * k / 20);
  return allocations - before;
}

TEST(FrameMemory, NothingIsAllocatedAFrame) {
  const test::Arm arm = test::make_arm();
  EXPECT_EQ(allocated(test::compile_figure(arm.anatomy, arm.skin)), 0);
}

TEST(FrameMemory, NothingIsAllocatedAFrameOfARefinedSkin) {
  const test::Arm arm = test::make_arm();
  const Refinement refinement = refine(arm.skin.F, int(arm.skin.V.rows()), 2);
  const BaseSkin base{arm.skin, refinement};
  const TriMesh fine{refine_points(refinement, arm.skin.V), refinement.F};
  EXPECT_EQ(allocated(test::compile_figure(arm.anatomy, fine, {.base = &base})), 0);
}

TEST(FrameMemory, NothingIsAllocatedAFrameOfMusclesThatAMapCarries) {
  const test::Arm arm = test::make_arm();
  const CharacterModel model =
      test::compile_figure(arm.anatomy, arm.skin, {.muscles = MuscleMotion::map});
  CharacterState state(model);
  Pose pose = rest_pose(arm.anatomy.skeleton);
  const auto play = [&](double degrees) {
    pose.rotations[3] = Quat(Eigen::AngleAxisd(-degrees * kDegree, Vec3::UnitX()));
    evaluate(model, pose, {}, state);
  };
  for (const double angle : {0.0, 20.0, 150.0, 150.0, 150.0}) play(angle);
  const long before = allocations;
  for (int k = 0; k < 20; ++k) play(150.0 * k / 20);
  EXPECT_EQ(allocations - before, 0);
}

TEST(FrameMemory, ACopiedStateGoesOnByItself) {
  const test::Arm arm = test::make_arm();
  const CharacterModel model = test::compile_figure(arm.anatomy, arm.skin);
  CharacterState state(model);
  evaluate(model, rest_pose(arm.anatomy.skeleton), {}, state);
  CharacterState copy = state;
  EXPECT_EQ(copy.skin.positions, state.skin.positions);
  EXPECT_EQ(copy.relaxed.positions, state.relaxed.positions);
  EXPECT_NE(copy.relaxed.positions.data(), state.relaxed.positions.data());
  const SkinFrame before = state.skin;
  Pose bent = rest_pose(arm.anatomy.skeleton);
  bent.rotations[3] = Quat(Eigen::AngleAxisd(-1.5, Vec3::UnitX()));
  evaluate(model, bent, {}, copy);
  EXPECT_EQ(state.skin.positions, before.positions) << "the original is left alone";
  evaluate(model, rest_pose(arm.anatomy.skeleton), {}, copy);
  EXPECT_EQ(copy.skin.positions, before.positions);
}

}  // namespace
}  // namespace ecorche
