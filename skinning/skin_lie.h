// Where points lie against a skin that moves: found by walking over the mesh from a vertex near them. Private to the room.
#pragma once

#include <span>
#include <vector>

#include "anatomy/types.h"
#include "skinning/float4.h"

namespace ecorche {

// Neighbours and triangles of every vertex, in fours (lanes.h); the last four repeats its first.
struct SkinRings {
  std::vector<int> near_begin, near;  // #V + 1, in fours; 4 a four: neighbours, or the vertex itself where it has none
  std::vector<int> fan_begin, fan;    // #V + 1, in fours; 8 a four: second, then third corners of triangles about the vertex
  std::vector<int> ring_begin, ring;  // #V + 1; neighbours, each once
};

SkinRings make_skin_rings(const TriMesh& skin);

struct PosedSkin {
  std::span<const float> positions, normals;  // #V x 4
};

struct Lie {
  int vertex = 0;     // nearest
  float height = 0;   // m over the skin, negative below
  Float4 normal{};    // outward, unit, w = 0
};

// m: below that the height is that over the plane of the nearest vertex.
inline constexpr float kDeepLie = 0.005f;

// `p`: relative to the vertex `from`, w = 0.
Lie lie_of(const SkinRings& rings, const PosedSkin& skin, Float4 p, int from);

}  // namespace ecorche
