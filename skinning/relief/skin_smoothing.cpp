#include "skinning/relief/skin_smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/vertex_rings.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kCut = 2.5;  // widths
// Of a Gaussian in the plane that is cut off at kCut, to the width of what is left.
constexpr double kUncut = 1.144;
constexpr std::size_t kGrain = 4096;  // vertices a task

struct Row {
  std::vector<int> vertex;
  std::vector<float> weight;
};

}  // namespace

SurfaceGraph graph_of(const TriMesh& skin) {
  return {skin.V, vertex_neighbours(skin), vertex_areas(skin)};
}

double mean_edge(const SurfaceGraph& graph, int v) {
  const std::vector<int>& ring = graph.ring[std::size_t(v)];
  double sum = 0;
  for (const int other : ring) sum += (graph.at.row(other) - graph.at.row(v)).norm();
  return ring.empty() ? 1 : std::max(sum / double(ring.size()), 1e-6);
}

SkinSmoothing make_smoothing(const SurfaceGraph& skin, double width, double most_edges,
                             std::span<const char> wanted) {
  const auto& [points, ring, area] = skin;
  std::vector<Row> rows(ring.size());
  parallel_for_ranges(rows.size(), kGrain, Threads::all, [&](std::size_t begin, std::size_t end) {
    std::vector<std::size_t> seen_by(rows.size(), rows.size());
    for (std::size_t v = begin; v < end; ++v) {
      Row& row = rows[v];
      const Vec3 at = points.row(Eigen::Index(v));
      const double w = std::min(width, most_edges * mean_edge(skin, int(v)));
      const double reach = kCut * kCut * w * w, spread = kUncut * kUncut * w * w;
      double sum = 0;
      seen_by[v] = v;
      row.vertex.push_back(int(v));
      for (std::size_t next = 0; next < row.vertex.size(); ++next) {
        const int u = row.vertex[next];
        const double far = (Vec3(points.row(u)) - at).squaredNorm();
        const double weight = std::max(area[u], 1e-12) * std::exp(-0.5 * far / spread);
        row.weight.push_back(float(weight));
        sum += weight;
        if (!wanted[v]) break;
        for (const int other : ring[u])
          if (seen_by[other] != v && (Vec3(points.row(other)) - at).squaredNorm() < reach) {
            seen_by[other] = v;
            row.vertex.push_back(other);
          }
      }
      for (float& weight : row.weight) weight /= float(sum);
    }
  });
  SkinSmoothing out;
  out.first.push_back(0);
  for (const Row& row : rows) {
    out.vertex.insert(out.vertex.end(), row.vertex.begin(), row.vertex.end());
    out.weight.insert(out.weight.end(), row.weight.begin(), row.weight.end());
    out.first.push_back(int(out.vertex.size()));
  }
  return out;
}

void smooth(const SkinSmoothing& smoothing, std::span<const float> values, std::span<float> out) {
  parallel_for_ranges(out.size(), kGrain, Threads::all, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      float sum = 0;
      for (int k = smoothing.first[v]; k < smoothing.first[v + 1]; ++k)
        sum += smoothing.weight[k] * values[smoothing.vertex[k]];
      out[v] = sum;
    }
  });
}

}  // namespace ecorche::inline v1
