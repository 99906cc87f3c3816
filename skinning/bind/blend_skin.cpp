#include "skinning/bind/blend_skin.h"

#include <fmt/format.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <cstdint>
#include <stdexcept>

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kRuns = 32;  // a task

using Eight = Eigen::Array<float, 8, 1>;
using Four = Eigen::Array<float, 4, 1>;

// Sum of the frames at a vertex.
struct BlendedMap {
  Eight low = Eight::Zero(), high = Eight::Zero();  // columns 0 and 1; columns 2 and 3

  Four turn(const float* X) const {
    return low.head<4>() * X[0] + low.tail<4>() * X[1] + high.head<4>() * X[2];
  }
};

// Calls act(e, map) for the vertices of a run. All of them blend the same number of frames, so that
// the inner loop has a constant length.
template <int kFrames, class Act>
void blend_maps(const BlendMesh& mesh, const VertexRun& run, const float* maps, const Act& act) {
  const int count = kFrames > 0 ? kFrames : run.frames;
  const std::uint16_t* frame = &mesh.frame[run.frame_entry];
  const float* weight = &mesh.frame_weight[run.frame_entry];
  for (int e = run.begin; e < run.end; ++e, frame += count, weight += count) {
    BlendedMap sum;
    for (int k = 0; k < count; ++k) {
      const float* map = maps + 16 * frame[k];
      sum.low += weight[k] * Eigen::Map<const Eight>(map);
      sum.high += weight[k] * Eigen::Map<const Eight>(map + 8);
    }
    act(e, sum);
  }
}

template <class Act>
void blend_run(const BlendMesh& mesh, const VertexRun& run, const float* maps, const Act& act) {
  switch (run.frames) {
    case 1:
      return blend_maps<1>(mesh, run, maps, act);
    case 2:
      return blend_maps<2>(mesh, run, maps, act);
    case 3:
      return blend_maps<3>(mesh, run, maps, act);
    case 4:
      return blend_maps<4>(mesh, run, maps, act);
    case 5:
      return blend_maps<5>(mesh, run, maps, act);
    case 6:
      return blend_maps<6>(mesh, run, maps, act);
    default:
      return blend_maps<0>(mesh, run, maps, act);
  }
}

template <class Act>
void each_run(const BlendMesh& mesh, const Act& act) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.runs.size(), kRuns),
                    [&](const auto& range) {
                      for (std::size_t r = range.begin(); r < range.end(); ++r) act(mesh.runs[r]);
                    });
}

}  // namespace

void pose_blend(const BlendTables& tables, const PosedAnatomy& posed, BlendPose& out) {
  if (int(posed.X_WJ.size()) != tables.frames.joint_count() ||
      int(posed.slices.size()) != tables.slice_count)
    throw std::invalid_argument(fmt::format(
        "deform_skin: the pose has {} joints and {} slices, the binding {} and {}",
        posed.X_WJ.size(), posed.slices.size(), tables.frames.joint_count(), tables.slice_count));
  pose_blend_frames(tables.frames, posed.X_WJ, out.frames);
  offset_handles(tables, posed, out.frames.maps, out.handles);
  out.root = posed.X_WJ[0].translation();
}

void blend_skin(const BlendMesh& mesh, const BlendPose& pose, std::span<float> positions) {
  const float* maps = pose.frames.maps.data();
  const float* offsets = pose.handles.offsets.data();
  const Four root(float(pose.root.x()), float(pose.root.y()), float(pose.root.z()), 1.0f);
  each_run(mesh, [&](const VertexRun& run) {
    const std::uint16_t* handle = mesh.handle.data() + run.handle_entry;
    const float* handle_weight = mesh.handle_weight.data() + run.handle_entry;
    blend_run(mesh, run, maps, [&](int e, const BlendedMap& map) {
      Four p = root + map.turn(&mesh.rest[4 * e]) + map.high.tail<4>();
      for (int k = 0; k < run.handles; ++k)
        p += handle_weight[k] * Eigen::Map<const Four>(offsets + 4 * handle[k]);
      handle += run.handles;
      handle_weight += run.handles;
      Eigen::Map<Four> target(&positions[4 * std::size_t(mesh.sorted_index[e])]);
      target = p;
    });
  });
}

void add_blended_offsets(const BlendMesh& mesh, const BlendPose& pose,
                         std::span<const float> offsets, std::span<float> positions) {
  const float* maps = pose.frames.maps.data();
  each_run(mesh, [&](const VertexRun& run) {
    blend_run(mesh, run, maps, [&](int e, const BlendedMap& map) {
      Eigen::Map<Four> target(&positions[4 * std::size_t(mesh.sorted_index[e])]);
      target += map.turn(&offsets[4 * e]);
    });
  });
}

}  // namespace ecorche::inline v1
