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

// All vertices of a run blend the same number of frames, so the inner loop has a constant length.
template <int kFrames>
void blend_run(const BlendMesh& mesh, const VertexRun& run, const float* maps, const float* offsets,
               const Four& root, float* out) {
  const int count = kFrames > 0 ? kFrames : run.frames;
  const std::uint16_t* frame = &mesh.frame[run.frame_entry];
  const float* weight = &mesh.frame_weight[run.frame_entry];
  const std::uint16_t* handle = mesh.handle.data() + run.handle_entry;
  const float* handle_weight = mesh.handle_weight.data() + run.handle_entry;
  for (int e = run.begin; e < run.end; ++e, frame += count, weight += count) {
    Eight low = Eight::Zero(), high = Eight::Zero();  // columns 0 and 1; columns 2 and 3
    for (int k = 0; k < count; ++k) {
      const float* map = maps + 16 * frame[k];
      low += weight[k] * Eigen::Map<const Eight>(map);
      high += weight[k] * Eigen::Map<const Eight>(map + 8);
    }
    const float* X = &mesh.rest[4 * e];
    Four p =
        root + low.head<4>() * X[0] + low.tail<4>() * X[1] + high.head<4>() * X[2] + high.tail<4>();
    for (int k = 0; k < run.handles; ++k)
      p += handle_weight[k] * Eigen::Map<const Four>(offsets + 4 * handle[k]);
    handle += run.handles;
    handle_weight += run.handles;
    Eigen::Map<Four> target(out + 4 * std::size_t(mesh.sorted_index[e]));
    target = p;
  }
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
  float* out = positions.data();
  const auto blend = [&](const VertexRun& run) {
    switch (run.frames) {
      case 1:
        return blend_run<1>(mesh, run, maps, offsets, root, out);
      case 2:
        return blend_run<2>(mesh, run, maps, offsets, root, out);
      case 3:
        return blend_run<3>(mesh, run, maps, offsets, root, out);
      case 4:
        return blend_run<4>(mesh, run, maps, offsets, root, out);
      case 5:
        return blend_run<5>(mesh, run, maps, offsets, root, out);
      case 6:
        return blend_run<6>(mesh, run, maps, offsets, root, out);
      default:
        return blend_run<0>(mesh, run, maps, offsets, root, out);
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.runs.size(), kRuns),
                    [&](const auto& range) {
                      for (std::size_t r = range.begin(); r < range.end(); ++r) blend(mesh.runs[r]);
                    });
}

}  // namespace ecorche::inline v1
