#include "morph/fit/layer_gaps.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

// Between the fat layer and what lies beneath: m, and the share of the layer, whose thicknesses are
// a table's for builds; single people differ by more.
constexpr double kNear = 0.005, kNearOfLayer = 0.25;

bool is_filled_part(BodyPart part) {
  return part == BodyPart::trunk || part == BodyPart::upper_arm || part == BodyPart::forearm ||
         part == BodyPart::thigh || part == BodyPart::shank;
}

}  // namespace

std::vector<int> vertices_over_flesh(const TriMesh& wall, const std::vector<VertexPart>& parts) {
  const std::vector<double> areas = vertex_areas(wall);
  std::vector<int> out;
  for (int i = 0; i < int(parts.size()); ++i)
    if (areas[std::size_t(i)] > 0 && is_filled_part(parts[std::size_t(i)].part)) out.push_back(i);
  return out;
}

LayerGaps measure_layer_gaps(const TriMesh& wall, const FatLayer& fat,
                             const std::vector<VertexPart>& parts, const TriMesh& flesh,
                             const TriMesh& fascia) {
  const Points normals = vertex_normals(wall);
  const std::vector<double> areas = vertex_areas(wall);
  LayerGaps out;
  const std::vector<int> vertices = vertices_over_flesh(wall, parts);
  Points under(vertices.size(), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const int i = vertices[k];
    under.row(Eigen::Index(k)) =
        wall.V.row(i) - double(fat.thickness[std::size_t(i)]) * normals.row(i);
  }
  const std::vector<int> winding = winding_numbers(flesh, under);
  const NearestSurface nearest(join_meshes({&flesh, &fascia}));
  struct Gap {
    double gap = 0, area = 0;
    bool filled = false;
  };
  std::vector<Gap> gaps(vertices.size());
  tbb::parallel_for(std::size_t{0}, gaps.size(), [&](std::size_t k) {
    const std::size_t i = std::size_t(vertices[k]);
    const double gap = winding[k] != 0 ? 0 : nearest.nearest(under.row(Eigen::Index(k))).distance;
    gaps[k] = {gap, areas[i], gap <= std::max(kNear, kNearOfLayer * double(fat.thickness[i]))};
  });
  std::ranges::sort(gaps, {}, &Gap::gap);
  double area = 0, near = 0, sum = 0;
  for (const Gap& one : gaps) area += one.area, near += one.filled ? one.area : 0;
  for (const Gap& one : gaps) {
    if (sum < 0.5 * area) out.median = one.gap;
    if (sum < 0.95 * area) out.p95 = one.gap;
    sum += one.area;
  }
  out.filled_share = near / area;
  return out;
}

}  // namespace ecorche::inline v1
