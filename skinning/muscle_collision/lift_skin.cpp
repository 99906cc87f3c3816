#include "skinning/muscle_collision/lift_skin.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <limits>

namespace ecorche::inline v1 {
namespace {

constexpr LiftParameters kParameters;
// m: a smaller lift stops in no fold, as normals meet half an edge away at the nearest
constexpr float kNoLift = 1e-5f;
constexpr std::size_t kBlock = 512;  // vertices a task

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

// Smooths the lift, in the first `upwards` rounds only upwards. Each round reaches one ring of
// vertices further.
void spread(const SkinRings& rings, int rounds, int upwards, LiftWorkspace& s) {
  std::size_t begin = 0;
  for (int round = 0; round < rounds; ++round) {
    const std::size_t end = s.vertices.size();
    for (; begin < end; ++begin)
      for (int u : ring_of(rings, s.vertices[begin])) meet(u, s);
    s.lift.swap(s.before);
    each(s, [&](int v) {
      const float mean = mean_about(rings, v, s.before);
      s.lift[v] = round < upwards ? std::max(s.before[v], mean) : mean;
    });
  }
}

// m: the part of the way to where a neighbour's normal meets a vertex's own, as normals of a fold
// do.
float way_to_fold(const SkinRings& rings, std::span<const float> positions,
                  std::span<const float> normals, int v, float fraction) {
  float out = std::numeric_limits<float>::max();
  const Float4 p = load4(&positions[4 * v]), n = load4(&normals[4 * v]);
  for (int u : ring_of(rings, v)) {
    const Float4 edge = load4(&positions[4 * u]) - p;
    const float nearing = sum4((n - load4(&normals[4 * u])) * edge)[0];
    if (nearing > 0) out = std::min(out, fraction * sum4(edge * edge)[0] / nearing);
  }
  return out;
}

// In a fold the skin is lifted by no more than a part of the way to where its normals meet.
void spare_folds(const SkinRings& rings, std::span<const float> positions,
                 std::span<const float> normals, LiftWorkspace& s) {
  each(s, [&](int v) {
    float& lift = s.lift[v];
    if (lift > kNoLift)
      lift = std::min(lift, way_to_fold(rings, positions, normals, v, kParameters.fold_fraction));
  });
}

// Smooths values of all vertices downwards.
void ease_down(const SkinRings& rings, int rounds, std::vector<float>& values,
               std::vector<float>& before) {
  before.resize(values.size());
  for (int round = 0; round < rounds; ++round) {
    values.swap(before);
    tbb::parallel_for(tbb::blocked_range<int>(0, int(values.size()), kBlock),
                      [&](const auto& range) {
                        for (int v = range.begin(); v < range.end(); ++v)
                          values[v] = std::min(before[v], mean_about(rings, v, before));
                      });
  }
}

}  // namespace

void begin_raise(const SkinRings& rings, std::span<const float> positions,
                 std::span<const float> normals, LiftWorkspace& s) {
  const std::size_t n = positions.size() / 4;
  s.rise.assign(n, 0);
  s.unraised.assign(positions.begin(), positions.end());
  s.normals.assign(normals.begin(), normals.end());
  s.most.assign(n, kParameters.most_depth);
  tbb::parallel_for(tbb::blocked_range<int>(0, int(n), kBlock), [&](const auto& range) {
    for (int v = range.begin(); v < range.end(); ++v)
      s.most[v] = std::min(
          s.most[v], way_to_fold(rings, positions, normals, v, kParameters.bone_fold_fraction));
  });
  ease_down(rings, kParameters.easing_rounds, s.most, s.before);
}

void raise_skin(const SkinRings& rings, std::span<const SkinPenetration> points,
                std::span<float> positions, LiftWorkspace& s) {
  s.met.assign(s.rise.size(), 0);
  s.vertices.clear();
  s.lift = s.rise;
  for (const SkinPenetration& point : points) {
    meet(point.vertex, s);
    s.lift[point.vertex] = std::max(s.lift[point.vertex], s.rise[point.vertex] + point.depth);
  }
  s.before = s.lift;
  spread(rings, kParameters.raise_rounds, kParameters.raise_rounds, s);
  each(s, [&](int v) {
    s.rise[v] = std::min(s.lift[v], s.most[v]);
    store4(&positions[4 * v], load4(&s.unraised[4 * v]) + s.rise[v] * load4(&s.normals[4 * v]));
  });
}

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
  ease_down(rings, kParameters.clearance_rounds, clearance, s.before);
  s.before.assign(n, 0);
  spread(rings, kParameters.spread_rounds, kParameters.spread_rounds / 2, s);
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
