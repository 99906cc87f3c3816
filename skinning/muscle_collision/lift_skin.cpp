#include "skinning/muscle_collision/lift_skin.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

namespace ecorche::inline v1 {
namespace {

constexpr LiftParameters kParameters;
// m: a smaller lift stops in no fold, as normals meet half an edge away at the nearest
constexpr float kNoLift = 1e-5f;
constexpr std::size_t kBlock = 512;  // vertices a task

std::span<const int> ring_of(const SkinRings& rings, int v) {
  return {rings.ring.data() + rings.ring_begin[v], rings.ring.data() + rings.ring_begin[v + 1]};
}

void meet(int v, LiftWorkspace& s) {
  if (s.met[v]) return;
  s.met[v] = 1;
  s.vertices.push_back(v);
}

float mean_about(const SkinRings& rings, int v, const std::vector<float>& of) {
  const std::span<const int> ring = ring_of(rings, v);
  float sum = of[v];
  for (int u : ring) sum += of[u];
  return sum / float(ring.size() + 1);
}

template <class Do>
void each(const LiftWorkspace& s, const Do& act) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, s.vertices.size(), kBlock),
                    [&](const auto& range) {
                      for (std::size_t k = range.begin(); k < range.end(); ++k) act(s.vertices[k]);
                    });
}

// Each round reaches one ring of vertices further.
void spread(const SkinRings& rings, LiftWorkspace& s) {
  std::size_t begin = 0;
  for (int round = 0; round < kParameters.spread_rounds; ++round) {
    const std::size_t end = s.vertices.size();
    for (; begin < end; ++begin)
      for (int u : ring_of(rings, s.vertices[begin])) meet(u, s);
    s.lift.swap(s.before);
    each(s, [&](int v) {
      const float mean = mean_about(rings, v, s.before);
      s.lift[v] = round < kParameters.spread_rounds / 2 ? std::max(s.before[v], mean) : mean;
    });
  }
}

// In a fold normals run together: the skin is lifted by no more than an eighth of the way to where
// a neighbour's normal meets its own.
void spare_folds(const SkinRings& rings, std::span<const float> positions,
                 std::span<const float> normals, LiftWorkspace& s) {
  each(s, [&](int v) {
    float& most = s.lift[v];
    if (most < kNoLift) return;
    const Float4 p = load4(&positions[4 * v]), n = load4(&normals[4 * v]);
    for (int u : ring_of(rings, v)) {
      const Float4 edge = load4(&positions[4 * u]) - p;
      const float nearing = sum4((n - load4(&normals[4 * u])) * edge)[0];
      if (nearing > 0)
        most = std::min(most, kParameters.fold_fraction * sum4(edge * edge)[0] / nearing);
    }
  });
}

void smooth_clearance(const SkinRings& rings, LiftWorkspace& s, std::vector<float>& clearance) {
  for (int round = 0; round < kParameters.clearance_rounds; ++round) {
    tbb::parallel_for(tbb::blocked_range<int>(0, int(clearance.size()), kBlock),
                      [&](const auto& range) {
                        for (int v = range.begin(); v < range.end(); ++v)
                          s.before[v] = std::min(clearance[v], mean_about(rings, v, clearance));
                      });
    clearance.swap(s.before);
  }
  s.before.assign(clearance.size(), 0);
}

}  // namespace

bool lift_skin(const SkinRings& rings, std::span<const SkinPenetration> points,
               std::span<const float> normals, std::span<const float> liftable,
               std::span<float> positions, std::vector<float>& clearance, LiftWorkspace& s) {
  const std::size_t n = positions.size() / 4;
  s.lift.assign(n, 0);
  s.before.assign(n, 0);
  s.met.assign(n, 0);
  s.vertices.clear();
  s.vertices.reserve(n);
  clearance.assign(n, 1);
  for (const auto& [vertex, depth] : points) {
    float& free = clearance[vertex];
    free = std::min(free, std::max(0.0f, -depth / kClearance));
    if (!(depth > 0)) continue;
    meet(vertex, s);
    s.lift[vertex] = std::max(s.lift[vertex],
                              kParameters.skin_fraction * std::min(depth, kParameters.most_depth));
  }
  if (s.vertices.empty()) return false;
  smooth_clearance(rings, s, clearance);
  spread(rings, s);
  spare_folds(rings, positions, normals, s);
  for (int v : s.vertices) s.lift[v] *= std::min(1.0f, kParameters.liftable_gain * liftable[v]);
  for (int round = 0; round < kParameters.easing_rounds; ++round) {  // round about a fold too
    s.lift.swap(s.before);
    each(s, [&](int v) { s.lift[v] = std::min(s.before[v], mean_about(rings, v, s.before)); });
  }
  for (int v : s.vertices) {
    float* p = &positions[4 * v];
    store4(p, load4(p) + s.lift[v] * load4(&normals[4 * v]));
  }
  return true;
}

}  // namespace ecorche::inline v1
