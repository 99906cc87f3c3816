#include "skinning/muscle_collision/lift_skin.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

namespace ecorche {
namespace {

constexpr float kMostOut = 0.06f;    // m
constexpr float kSkinShare = 0.85f;  // of the way out that the skin rises
constexpr int kRoomRounds = 2;
constexpr int kSpreading = 8;  // rounds, the first half of them only upwards
constexpr int kEasing = 4;     // rounds
constexpr float kOpen = 4;     // the skin rises freely where it is at least a quarter open
constexpr float kFoldShare = 0.12f;
// m: what is less stops in no fold, as normals meet half an edge away at the nearest
constexpr float kNoRise = 1e-5f;
constexpr std::size_t kBlock = 512;

std::size_t index(int i) { return std::size_t(i); }

std::span<const int> ring_of(const SkinRings& rings, int v) {
  return {rings.ring.data() + rings.ring_begin[index(v)],
          rings.ring.data() + rings.ring_begin[index(v) + 1]};
}

void meet(int v, RiseScratch& s) {
  if (s.met[index(v)]) return;
  s.met[index(v)] = 1;
  s.vertices.push_back(v);
}

float mean_about(const SkinRings& rings, int v, const std::vector<float>& of) {
  const std::span<const int> ring = ring_of(rings, v);
  float sum = of[index(v)];
  for (int u : ring) sum += of[index(u)];
  return sum / float(ring.size() + 1);
}

template <class Do>
void each(const RiseScratch& s, const Do& act) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, s.vertices.size(), kBlock),
                    [&](const auto& range) {
                      for (std::size_t k = range.begin(); k < range.end(); ++k) act(s.vertices[k]);
                    });
}

// Each round reaches one ring of vertices further.
void spread(const SkinRings& rings, RiseScratch& s) {
  std::size_t begin = 0;
  for (int round = 0; round < kSpreading; ++round) {
    const std::size_t end = s.vertices.size();
    for (; begin < end; ++begin)
      for (int u : ring_of(rings, s.vertices[begin])) meet(u, s);
    s.rise.swap(s.before);
    each(s, [&](int v) {
      const float mean = mean_about(rings, v, s.before);
      s.rise[index(v)] = round < kSpreading / 2 ? std::max(s.before[index(v)], mean) : mean;
    });
  }
}

// In a fold normals run together: the skin goes an eighth of the way to where a neighbour's meets
// its own.
void spare_folds(const SkinRings& rings, std::span<const float> positions,
                 std::span<const float> normals, RiseScratch& s) {
  each(s, [&](int v) {
    float& most = s.rise[index(v)];
    if (most < kNoRise) return;
    const Float4 p = load4(&positions[4 * index(v)]), n = load4(&normals[4 * index(v)]);
    for (int u : ring_of(rings, v)) {
      const Float4 edge = load4(&positions[4 * index(u)]) - p;
      const float nearing = sum4((n - load4(&normals[4 * index(u)])) * edge)[0];
      if (nearing > 0) most = std::min(most, kFoldShare * sum4(edge * edge)[0] / nearing);
    }
  });
}

void smooth_room(const SkinRings& rings, RiseScratch& s) {
  for (int round = 0; round < kRoomRounds; ++round) {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, int(s.room.size()), kBlock), [&](const auto& range) {
          for (int v = range.begin(); v < range.end(); ++v)
            s.before[index(v)] = std::min(s.room[index(v)], mean_about(rings, v, s.room));
        });
    s.room.swap(s.before);
  }
  s.before.assign(s.room.size(), 0);
}

}  // namespace

bool rise(const SkinRings& rings, std::span<const Pierce> points, std::span<const float> normals,
          std::span<const float> open, std::span<float> positions, RiseScratch& s) {
  const std::size_t n = positions.size() / 4;
  s.rise.assign(n, 0);
  s.before.assign(n, 0);
  s.met.assign(n, 0);
  s.vertices.clear();
  s.vertices.reserve(n);
  s.room.assign(n, 1);
  for (const auto& [vertex, out] : points) {
    float& room = s.room[index(vertex)];
    room = std::min(room, std::max(0.0f, -out / kRoom));
    if (!(out > 0)) continue;
    meet(vertex, s);
    s.rise[index(vertex)] = std::max(s.rise[index(vertex)], kSkinShare * std::min(out, kMostOut));
  }
  if (s.vertices.empty()) return false;
  smooth_room(rings, s);
  spread(rings, s);
  spare_folds(rings, positions, normals, s);
  for (int v : s.vertices) s.rise[index(v)] *= std::min(1.0f, kOpen * open[index(v)]);
  for (int round = 0; round < kEasing; ++round) {  // round about a fold too
    s.rise.swap(s.before);
    each(s, [&](int v) {
      s.rise[index(v)] = std::min(s.before[index(v)], mean_about(rings, v, s.before));
    });
  }
  for (int v : s.vertices) {
    float* p = &positions[4 * index(v)];
    store4(p, load4(p) + s.rise[index(v)] * load4(&normals[4 * index(v)]));
  }
  return true;
}

}  // namespace ecorche
