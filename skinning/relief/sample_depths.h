// How deep the anatomy lies beneath each vertex of a skin. Private to the library.
//
// Samples are sorted into a grid each frame, so that whatever slides beneath a vertex is found. The
// depth along the vertex's normal is a moving mean, weighted by (1 - r^2 / kReach^2)^2 over the
// distance r from that line, of the planes through the samples. It is continuous in positions of
// skin and samples, and so in time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "anatomy/types.h"
#include "skinning/relief/surface_samples.h"

namespace ecorche::inline v1 {

// m. Larger: furrows fill; smaller: too few samples, and the depth gets their pattern.
constexpr float kReach = 0.010f;

// Vertices in groups of eight that are near each other.
struct DepthGroups {
  std::vector<int> vertex;  // 8 a group; the last group repeats its last vertex
};
// Of the vertices for which `wanted` is not 0.
DepthGroups make_depth_groups(const Points& skin, std::span<const char> wanted);

struct SampleGrid {
  std::vector<int> first;             // #buckets + 1
  std::vector<std::int64_t> cell;     // #samples, in the order of their buckets
  std::vector<float> rows;            // #samples x 8: position, normal
  std::vector<std::int64_t> cell_of;  // workspaces
  std::vector<int> next;
};
void fill_grid(const PosedSamples& samples, SampleGrid& grid);

// `depth`: #V m, in and out: the depth that is expected, which stays where no sample is near; what
// lies kSpan deeper or less deep counts as little more than that. Positions and normals: #V x 4.
void sample_depths(const DepthGroups& groups, const SampleGrid& grid,
                   std::span<const float> positions, std::span<const float> normals,
                   std::span<float> depth);

}  // namespace ecorche::inline v1
