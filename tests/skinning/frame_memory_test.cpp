// A frame writes into memory that it has had before: nothing is allocated once the first frames
// have sized it.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <numbers>

#include "anatomy/geometry/subdivide.h"
#include "anatomy/posing/pose_anatomy.h"
#include "skinning/character/deform_skin.h"
#include "skinning/muscle_collision/muscle_collision.h"
#include "tests/skinning/arm.h"

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

constexpr double kDegrees = std::numbers::pi / 180;

PosedAnatomy rest_of(const test::Arm& arm) {
  PosedAnatomy rest;
  pose_anatomy(make_posing_table(arm.anatomy), arm.anatomy.skeleton,
               rest_pose(arm.anatomy.skeleton), rest);
  return rest;
}

// Bends the elbow ever further, up to where forearm and upper arm meet, and counts what the frames
// after the first few allocate.
long allocated(const test::Arm& arm, const Binding& binding) {
  const Skeleton& skeleton = arm.anatomy.skeleton;
  const PosingTable table = make_posing_table(arm.anatomy);
  const UnderSkin under = make_under_skin(arm.anatomy, rest_of(arm), binding);
  PosedAnatomy posed;
  SkinFrame frame;
  UnderSkinMemory memory;
  Pose pose = rest_pose(skeleton);
  const auto play = [&](double angle) {
    pose.rotations[3] = Quat(Eigen::AngleAxisd(-angle, Vec3::UnitX()));
    pose_anatomy(table, skeleton, pose, posed);
    for (Ellipse& slice : posed.slices) slice.center.z() += 0.02;  // the muscle comes out
    deform_over_muscles(binding, under, {}, posed, frame, memory);
    give_way_to_skin(binding, under, table, frame, posed, memory);
  };
  for (const double angle : {0.0, 20.0, 150.0, 150.0, 150.0}) play(angle * kDegrees);
  const long before = allocations;
  for (int k = 0; k < 20; ++k) play(150 * kDegrees * k / 20);
  return allocations - before;
}

TEST(FrameMemory, NothingIsAllocatedAFrame) {
  const test::Arm arm = test::make_arm();
  EXPECT_EQ(allocated(arm, bind_skin(arm.anatomy, rest_of(arm), arm.skin)), 0);
}

TEST(FrameMemory, NothingIsAllocatedAFrameOfARefinedSkin) {
  const test::Arm arm = test::make_arm();
  const TriMesh& base = arm.skin;
  const Refinement refinement = refine(base.F, int(base.V.rows()), 2);
  const TriMesh fine{refine_points(refinement, base.V), refinement.F};
  EXPECT_EQ(allocated(arm, bind_skin(arm.anatomy, rest_of(arm), base, refinement, fine)), 0);
}

TEST(FrameMemory, ACopiedFrameGoesOnByItself) {
  const test::Arm arm = test::make_arm();
  const Binding binding = bind_skin(arm.anatomy, rest_of(arm), arm.skin);
  const PosedAnatomy posed = rest_of(arm);
  SkinFrame frame;
  deform_skin(binding, posed, frame);
  SkinFrame copy = frame;
  EXPECT_EQ(copy.positions, frame.positions);
  EXPECT_EQ(copy.scratch.elastic.memory, nullptr);
  deform_skin(binding, posed, copy);
  EXPECT_EQ(copy.positions, frame.positions);
  EXPECT_NE(copy.scratch.elastic.memory, frame.scratch.elastic.memory);
}

}  // namespace
}  // namespace ecorche
