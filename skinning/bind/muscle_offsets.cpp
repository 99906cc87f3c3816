#include "skinning/bind/muscle_offsets.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace ecorche::inline v1 {
namespace {

constexpr int kSmoothing = 1;          // rounds
constexpr std::size_t kHandles = 64;   // a task
constexpr double kLeastRadius = 1e-4;  // m

// How far the tube's surface lies beyond p along the direction from the line to p, as a vector. The
// slice beneath p is found by one step along the line from the anchored one.
Vec3 surface_offset(const std::vector<Ellipse>& slices, const MuscleAnchor& anchor, const Vec3& p) {
  double place = anchor.position;
  int k = 0;
  for (int step = 0; step < 2; ++step) {
    k = std::clamp(int(place), anchor.first, anchor.last - 1);
    const Vec3 a = slices[k].center, b = slices[k + 1].center;
    const double spacing2 = std::max((b - a).squaredNorm(), 1e-10);
    place =
        std::clamp(k + (p - a).dot(b - a) / spacing2, anchor.position - 4.0, anchor.position + 4.0);
    place = std::clamp(place, double(anchor.first), double(anchor.last));
  }
  k = std::clamp(int(place), anchor.first, anchor.last - 1);
  const double u = place - k;
  const Ellipse& A = slices[k];
  const Ellipse& B = slices[k + 1];
  const Vec3 d = p - ((1 - u) * A.center + u * B.center);
  const Vec2 radii = ((1 - u) * A.radii + u * B.radii).cwiseMax(kLeastRadius);
  const Vec3 width = (1 - u) * A.axes.col(0) + u * B.axes.col(0),
             thickness = (1 - u) * A.axes.col(1) + u * B.axes.col(1);
  const double aslant = width.dot(thickness), upright = 1 - aslant * aslant;
  const double x = d.dot(width - aslant * thickness) / (upright * radii.x());
  const double y = d.dot(thickness - aslant * width) / (upright * radii.y());
  const double rho = std::sqrt(x * x + y * y);
  return rho > 0.2 ? Vec3(d * (1 / rho - 1)) : Vec3(Vec3::Zero());
}

// A handle's blend of frames.
void blend(const MuscleHandle& handle, const float* maps, Eigen::Matrix<float, 4, 4>& map) {
  map.setZero();
  for (const auto& [frame, weight] : handle.frames)
    map += weight * Eigen::Map<const Eigen::Matrix<float, 4, 4>>(maps + 16 * frame);
}

void smooth(const HandleTables& tables, const std::vector<float>& from, std::vector<float>& to) {
  for (std::size_t k = 0; k < tables.handles.size(); ++k) {
    const MuscleHandle& handle = tables.handles[k];
    Eigen::Array4f sum = Eigen::Array4f::Zero();
    for (int other : handle.ring) sum += Eigen::Map<const Eigen::Array4f>(&from[4 * other]);
    const float weight = 0.5f / float(std::max(handle.ring_size, 1));
    Eigen::Map<Eigen::Array4f> out(&to[4 * k]);
    out = 0.5f * Eigen::Map<const Eigen::Array4f>(&from[4 * k]) + weight * sum;
  }
}

}  // namespace

void level_handles(const PosedAnatomy& rest, HandleTables& tables) {
  for (MuscleHandle& handle : tables.handles)
    handle.rest_height =
        surface_offset(rest.slices, handle.anchor, handle.surface).dot(handle.normal);
}

void offset_handles(const BlendTables& tables, const PosedAnatomy& posed,
                    const std::vector<float>& maps, HandleWorkspace& out) {
  const std::vector<MuscleHandle>& handles = tables.handles.handles;
  out.offsets.resize(4 * handles.size());
  out.smoothed.resize(out.offsets.size());
  const Vec3 root = posed.X_WJ[0].translation(), rest_root = tables.frames.origins[0];
  const auto offset_handle = [&](std::size_t k) {
    const MuscleHandle& handle = handles[k];
    Eigen::Matrix<float, 4, 4> map;
    blend(handle, maps.data(), map);
    const Eigen::Vector3f X = (handle.surface - rest_root).cast<float>();
    const Vec3 p =
        (map.topLeftCorner<3, 3>() * X + map.topRightCorner<3, 1>()).cast<double>() + root;
    const Vec3 n =
        (map.topLeftCorner<3, 3>() * handle.normal.cast<float>()).normalized().cast<double>();
    const double height =
        surface_offset(posed.slices, handle.anchor, p).dot(n) - handle.rest_height;
    // The skin goes up and down with the muscle alike: bellies keep their volume, so that what
    // rises in one place sinks in another, and the limb need not make up for either. Both saturate
    // smoothly, so that a muscle that has left the handle altogether does not drag it along.
    const double offset =
        handle.weight * height / (1 + std::abs(height) / tables.handles.lift_limit);
    for (int r = 0; r < 3; ++r) out.offsets[4 * k + r] = float(offset * n[r]);
    out.offsets[4 * k + 3] = 0;
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, handles.size(), kHandles),
                    [&](const auto& range) {
                      for (std::size_t k = range.begin(); k < range.end(); ++k) offset_handle(k);
                    });
  for (int round = 0; round < kSmoothing; ++round) {
    smooth(tables.handles, out.offsets, out.smoothed);
    out.offsets.swap(out.smoothed);
  }
}

}  // namespace ecorche::inline v1
