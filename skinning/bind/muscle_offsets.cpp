#include "skinning/bind/muscle_offsets.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace ecorche {
namespace {

constexpr int kSmoothing = 1;
constexpr std::size_t kNodes = 64;     // a task
constexpr double kLeastRadius = 1e-4;  // m

// How far the tube's surface lies beyond p along the direction from the line to p, as a vector. The
// slice beneath p is found by one step along the line from the anchored one.
Vec3 surface_offset(const std::vector<Ellipse>& slices, const MuscleAnchor& anchor, const Vec3& p) {
  double place = anchor.place;
  int k = 0;
  for (int step = 0; step < 2; ++step) {
    k = std::clamp(int(place), anchor.first, anchor.last - 1);
    const Vec3 a = slices[k].center, b = slices[k + 1].center;
    const double spacing2 = std::max((b - a).squaredNorm(), 1e-10);
    place = std::clamp(k + (p - a).dot(b - a) / spacing2, anchor.place - 4.0, anchor.place + 4.0);
    place = std::clamp(place, double(anchor.first), double(anchor.last));
  }
  k = std::clamp(int(place), anchor.first, anchor.last - 1);
  const double u = place - k;
  const Ellipse& A = slices[k];
  const Ellipse& B = slices[k + 1];
  const Vec3 d = p - ((1 - u) * A.center + u * B.center);
  const Vec2 radii = ((1 - u) * A.radii + u * B.radii).cwiseMax(kLeastRadius);
  const double x = d.dot((1 - u) * A.axes.col(0) + u * B.axes.col(0)) / radii.x();
  const double y = d.dot((1 - u) * A.axes.col(1) + u * B.axes.col(1)) / radii.y();
  const double rho = std::sqrt(x * x + y * y);
  return rho > 0.2 ? Vec3(d * (1 / rho - 1)) : Vec3(Vec3::Zero());
}

// A node's blend of carriers.
void blend(const MuscleNode& node, const float* carriers, Eigen::Matrix<float, 4, 4>& map) {
  map.setZero();
  for (const auto& [carrier, weight] : node.carriers)
    map += weight * Eigen::Map<const Eigen::Matrix<float, 4, 4>>(carriers + 16 * carrier);
}

void smooth(const SkinTables& tables, const std::vector<float>& from, std::vector<float>& to) {
  for (std::size_t k = 0; k < tables.nodes.size(); ++k) {
    const MuscleNode& node = tables.nodes[k];
    Eigen::Array4f sum = Eigen::Array4f::Zero();
    for (int other : node.ring) sum += Eigen::Map<const Eigen::Array4f>(&from[4 * other]);
    const float share = 0.5f / float(std::max(node.ring_size, 1));
    Eigen::Map<Eigen::Array4f> out(&to[4 * k]);
    out = 0.5f * Eigen::Map<const Eigen::Array4f>(&from[4 * k]) + share * sum;
  }
}

}  // namespace

void level_nodes(const PosedAnatomy& rest, SkinTables& tables) {
  for (MuscleNode& node : tables.nodes)
    node.rest_height = surface_offset(rest.slices, node.anchor, node.surface).dot(node.normal);
}

void lift_nodes(const SkinTables& tables, const PosedAnatomy& posed,
                const std::vector<float>& carriers, std::vector<float>& lifts,
                std::vector<float>& working) {
  lifts.resize(4 * tables.nodes.size());
  working.resize(lifts.size());
  const Vec3 root = posed.X_WJ[0].translation(), rest_root = tables.origins[0];
  const auto lift_node = [&](std::size_t k) {
    const MuscleNode& node = tables.nodes[k];
    Eigen::Matrix<float, 4, 4> map;
    blend(node, carriers.data(), map);
    const Eigen::Vector3f X = (node.surface - rest_root).cast<float>();
    const Vec3 p =
        (map.topLeftCorner<3, 3>() * X + map.topRightCorner<3, 1>()).cast<double>() + root;
    const Vec3 n =
        (map.topLeftCorner<3, 3>() * node.normal.cast<float>()).normalized().cast<double>();
    const double height = surface_offset(posed.slices, node.anchor, p).dot(n) - node.rest_height;
    // The skin goes up and down with the muscle alike: bellies keep their volume, so that what
    // rises in one place sinks in another, and the limb need not make up for either. Both saturate
    // smoothly, so that a muscle that has left the node altogether does not drag it along.
    const double lift = node.weight * height / (1 + std::abs(height) / tables.lift_limit);
    for (int r = 0; r < 3; ++r) lifts[4 * k + r] = float(lift * n[r]);
    lifts[4 * k + 3] = 0;
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tables.nodes.size(), kNodes),
                    [&](const auto& range) {
                      for (std::size_t k = range.begin(); k < range.end(); ++k) lift_node(k);
                    });
  for (int round = 0; round < kSmoothing; ++round) {
    smooth(tables, lifts, working);
    lifts.swap(working);
  }
}

}  // namespace ecorche
