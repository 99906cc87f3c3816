#include "skinning/relief/sample_depths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/compute/simd_lanes.h"
#include "anatomy/geometry/vertex_order.h"

namespace ecorche::inline v1 {
namespace {

constexpr float kCell = 0.02f;  // m, sides of the grid's cells
constexpr std::size_t kBuckets = std::size_t{1} << 16;
constexpr float kSpan = 0.008f;      // m
constexpr float kExpected = 0.05f;   // weight of the expected depth; a sample's is at most 1
constexpr float kMostTilt = 0.004f;  // m, that a sample's plane may rise or fall from it

std::int64_t cell_key(int x, int y, int z) {
  constexpr std::int64_t kBias = 1 << 20;
  return ((x + kBias) << 42) | ((y + kBias) << 21) | (z + kBias);
}

std::size_t bucket_of(std::int64_t key) {
  return std::size_t((std::uint64_t(key) * 0x9E3779B97F4A7C15ull) >> 48) % kBuckets;
}

int cell_at(float x) { return int(std::floor(x / kCell)); }

struct Group {
  Wide3 p, n;
  Float8 expected, weight, depth;
  std::array<float, 3> low, high;  // box about what may count
};

void add_sample(const float* row, Group& group) {
  const Wide3 away{group.p.x - row[0], group.p.y - row[1], group.p.z - row[2]};
  const Float8 zero = all_eight(0);
  const Float8 straight = dot(away, group.n);
  const Float8 outside = dot(away, away) - straight * straight;
  if (lanes_that(outside < kReach * kReach) == 0) return;
  Float8 weight = most(zero, 1.0f - outside * (1 / (kReach * kReach)));
  const Float8 facing = most(zero, row[4] * group.n.x + row[5] * group.n.y + row[6] * group.n.z);
  const Float8 off = (straight - group.expected) * (1 / kSpan);
  const Float8 off2 = off * off;
  weight = weight * weight * facing * facing / (1.0f + off2 * off2);
  const Float8 plane =
      (row[4] * away.x + row[5] * away.y + row[6] * away.z) / most(all_eight(0.4f), facing);
  const Float8 tilt = most(all_eight(-kMostTilt), least(all_eight(kMostTilt), plane - straight));
  group.weight += weight;
  group.depth +=
      weight * most(all_eight(-kSpan), least(all_eight(kSpan), straight + tilt - group.expected));
}

void add_cell(const SampleGrid& grid, std::int64_t key, Group& group) {
  const std::size_t bucket = bucket_of(key);
  for (int i = grid.first[bucket]; i < grid.first[bucket + 1]; ++i) {
    if (grid.cell[i] != key) continue;
    const float* row = &grid.rows[8 * std::size_t(i)];
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k)
      inside = inside && row[k] >= group.low[k] && row[k] <= group.high[k];
    if (inside) add_sample(row, group);
  }
}

// The box about the lines from the vertices down to what may count.
void find_box(Group& group) {
  const Float8 near = most(all_eight(-0.004f), group.expected - kSpan),
               far = group.expected + 1.5f * kSpan;
  const Wide3 a{group.p.x - near * group.n.x, group.p.y - near * group.n.y,
                group.p.z - near * group.n.z};
  const Wide3 b{group.p.x - far * group.n.x, group.p.y - far * group.n.y,
                group.p.z - far * group.n.z};
  const Float8 low[] = {least(a.x, b.x), least(a.y, b.y), least(a.z, b.z)};
  const Float8 high[] = {most(a.x, b.x), most(a.y, b.y), most(a.z, b.z)};
  for (std::size_t k = 0; k < 3; ++k) {
    group.low[k] = low[k][0];
    group.high[k] = high[k][0];
    for (int lane = 1; lane < 8; ++lane) {
      group.low[k] = std::min(group.low[k], low[k][lane]);
      group.high[k] = std::max(group.high[k], high[k][lane]);
    }
    group.low[k] -= kReach;
    group.high[k] += kReach;
  }
}

}  // namespace

DepthGroups make_depth_groups(const Points& skin, std::span<const char> wanted) {
  DepthGroups out;
  for (const int v : spatial_order(skin))
    if (wanted[v]) out.vertex.push_back(v);
  while (out.vertex.size() % 8 != 0) out.vertex.push_back(out.vertex.back());
  return out;
}

void fill_grid(const PosedSamples& samples, SampleGrid& grid) {
  const std::size_t count = samples.positions.size() / 4;
  grid.first.assign(kBuckets + 1, 0);
  grid.cell_of.resize(count);
  grid.cell.resize(count);
  grid.rows.resize(8 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const float* p = &samples.positions[4 * i];
    grid.cell_of[i] = cell_key(cell_at(p[0]), cell_at(p[1]), cell_at(p[2]));
    ++grid.first[bucket_of(grid.cell_of[i]) + 1];
  }
  for (std::size_t b = 0; b < kBuckets; ++b) grid.first[b + 1] += grid.first[b];
  grid.next.assign(grid.first.begin(), grid.first.end() - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t to = std::size_t(grid.next[bucket_of(grid.cell_of[i])]++);
    grid.cell[to] = grid.cell_of[i];
    store4(&grid.rows[8 * to], load4(&samples.positions[4 * i]));
    store4(&grid.rows[8 * to + 4], load4(&samples.normals[4 * i]));
  }
}

void sample_depths(const DepthGroups& groups, const SampleGrid& grid,
                   std::span<const float> positions, std::span<const float> normals,
                   std::span<float> depth) {
  parallel_for_ranges(
      groups.vertex.size() / 8, 128, Threads::all, [&](std::size_t begin, std::size_t end) {
        for (std::size_t g = begin; g < end; ++g) {
          const int* vertex = &groups.vertex[8 * g];
          Group group;
          group.p = xyz(gather_eight(positions.data(), vertex));
          group.n = xyz(gather_eight(normals.data(), vertex));
          group.expected = group.weight = group.depth = all_eight(0);
          for (int lane = 0; lane < 8; ++lane) group.expected[lane] = depth[vertex[lane]];
          find_box(group);
          for (int x = cell_at(group.low[0]); x <= cell_at(group.high[0]); ++x)
            for (int y = cell_at(group.low[1]); y <= cell_at(group.high[1]); ++y)
              for (int z = cell_at(group.low[2]); z <= cell_at(group.high[2]); ++z)
                add_cell(grid, cell_key(x, y, z), group);
          const Float8 mean = group.expected + group.depth / (group.weight + kExpected);
          for (int lane = 0; lane < 8; ++lane) depth[vertex[lane]] = mean[lane];
        }
      });
}

}  // namespace ecorche::inline v1
