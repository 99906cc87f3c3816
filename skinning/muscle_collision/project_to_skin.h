// Projection of points onto a skin that moves: found by walking over the mesh from a vertex near
// them. Private to the room.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/compute/simd_lanes.h"
#include "anatomy/queries/nearest_surface.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Neighbours of every vertex, in the order of the triangles about it, eight at a time: each and the
// next bound a triangle with the vertex, and after the last comes the first. Longer rings go on in
// the next eight, which begin with the last one's eighth. A vertex without triangles has itself for
// neighbours.
struct SkinRings {
  struct Eight {
    std::array<int, 8> neighbour{};
    int triangles = 0;  // number of pairs, from the first on, that are triangles
  };
  std::vector<int> eight_begin;  // #V + 1
  std::vector<Eight> eights;
  std::vector<int> ring_begin, ring;  // #V + 1; neighbours, each once
};

inline std::span<const int> ring_of(const SkinRings& rings, int v) {
  return {rings.ring.data() + rings.ring_begin[v], rings.ring.data() + rings.ring_begin[v + 1]};
}

SkinRings make_skin_rings(const TriMesh& skin);

// A mesh as a skin that stands still.
struct StillSkin {
  std::vector<float> positions, normals;  // #V x 4
};

StillSkin make_still_skin(const TriMesh& mesh);

// Of the triangle that was hit, the vertex nearest to `p`.
int nearest_vertex(const TriMesh& skin, const SurfacePoint& hit, const Vec3& p);

struct PosedSkin {
  std::span<const float> positions, normals;  // #V x 4
};

// Projections of eight points.
struct SkinProjections {
  std::array<int, 8> vertex{};  // nearest
  Float8 height{};              // m over the skin, negative below
  Wide3 normal{};               // outward, unit
};

// m: below it heights are over the plane of the nearest vertex, above it over the nearest triangle.
inline constexpr float kDeepProjection = 0.005f;
// m, and in depths of the point: farther to the side of a vertex, another part of the skin may be
// nearer.
inline constexpr float kAside = 0.01f, kAsideDepths = 1.5f;

// `points`: relative to the vertices `from`. How one projections does not depend on the others.
SkinProjections project_to_skin(const SkinRings& rings, const PosedSkin& skin, const Wide3& points,
                                const std::array<int, 8>& from);

}  // namespace ecorche::inline v1
