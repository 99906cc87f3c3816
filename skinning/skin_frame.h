// A deformed skin: what one frame writes and the viewer, the exporters and the measurements read.
#pragma once

#include <memory>
#include <vector>

#include "anatomy/types.h"

namespace ecorche {

// Working memory of the elastic skin (skinning/elastic_skin.h), made at first use. A copy begins with none of its own.
struct ElasticScratch;
class ElasticMemory {
 public:
  ElasticMemory() = default;
  ElasticMemory(const ElasticMemory&) {}
  ElasticMemory& operator=(const ElasticMemory&) { return *this; }
  ElasticMemory(ElasticMemory&&) = default;
  ElasticMemory& operator=(ElasticMemory&&) = default;
  ElasticScratch& get();

 private:
  std::shared_ptr<ElasticScratch> scratch_;
};

// Four floats a vertex (x y z 1 and nx ny nz 0), world, metres, in the vertex order of the skin that was bound.
// Buffers are sized on first use and then reused.
struct SkinFrame {
  std::vector<float> positions;  // #V x 4
  std::vector<float> normals;    // #V x 4, unit length

  // Working memory of the deformer; its content means nothing between frames.
  struct Scratch {
    std::vector<Transform> frames;
    std::vector<Quat> turns;
    std::vector<float> carriers, lifts, lifts_working, positions, normals, base, offsets;
    ElasticMemory elastic;
  } scratch;
};

// Positions of a frame as doubles. `out` is resized once and then reused.
void to_points(const SkinFrame& frame, Points& out);

}  // namespace ecorche
