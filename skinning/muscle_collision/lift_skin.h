// The skin rises over what comes out of it, smoothly round about, and stays open in folds. Private
// to the room.
#pragma once

#include <span>
#include <vector>

#include "skinning/muscle_collision/skin_walk.h"

namespace ecorche {

// Where a point was found.
struct Pierce {
  int vertex = 0;
  float out = 0;  // m, that it is out of the skin by; negative: how deep it lies
};

// m: what lies deeper leaves the skin room to sink.
inline constexpr float kRoom = 0.005f;

struct RiseScratch {
  std::vector<float> rise, before;  // #V, m
  std::vector<float> room;          // #V, 0 where a point is at the surface .. 1 where none is near
  std::vector<char> met;            // #V
  std::vector<int> vertices;        // those that may rise
};

// The skin (#V x 4) rises along `normals` over points that are out of it, the less the less `open`
// (#V, 0 .. 1) it is. False where none is.
bool rise(const SkinRings& rings, std::span<const Pierce> points, std::span<const float> normals,
          std::span<const float> open, std::span<float> positions, RiseScratch& scratch);

}  // namespace ecorche
