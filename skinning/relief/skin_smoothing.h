// Smoothing of values on a skin by Gaussians of fixed width, made at rest. Private to the library.
#pragma once

#include <span>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Points of a surface and which of them are joined.
struct SurfaceGraph {
  Points at;                           // #V x 3, m
  std::vector<std::vector<int>> ring;  // #V
  std::vector<double> area;            // #V, m^2
};
SurfaceGraph graph_of(const TriMesh& skin);
double mean_edge(const SurfaceGraph& graph, int v);  // m, at least 1e-6; 1 of a lonely point

// A value of each vertex of one mesh as a mean of values of vertices of another, or the same.
struct SkinSmoothing {
  std::vector<int> first;  // #V + 1 into vertex, weight
  std::vector<int> vertex;
  std::vector<float> weight;  // each row's sum is 1
};

// Gaussian over the distance between vertices, times their areas, cut off; only what is joined by
// edges within the cut. `width`: standard deviation of what is left, m; narrower where that is more
// than `most_edges` edges of the vertex, as on hands and feet, which have no room for more. Where
// edges are longer than that, or `wanted` is 0, the value stays. `wanted`: #V.
SkinSmoothing make_smoothing(const SurfaceGraph& skin, double width, double most_edges,
                             std::span<const char> wanted);

// Precondition: as many values as the smoothing was made for; `out` is another array.
void smooth(const SkinSmoothing& smoothing, std::span<const float> values, std::span<float> out);

}  // namespace ecorche::inline v1
