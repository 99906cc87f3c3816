// A deformed skin: what one frame writes and the viewer, the exporters and the measurements read.
#pragma once

#include <memory>
#include <vector>

#include "anatomy/types.h"

namespace ecorche {

struct ElasticScratch;

// The elastic skin's share of a frame's working memory, made when it is first needed. A copied
// frame makes its own.
struct OwnElastic {
  OwnElastic() = default;
  OwnElastic(OwnElastic&&) = default;
  OwnElastic& operator=(OwnElastic&&) = default;
  OwnElastic(const OwnElastic&) {}
  OwnElastic& operator=(const OwnElastic&) { return *this; }

  std::shared_ptr<ElasticScratch> memory;
};

// Four floats a vertex (x y z 1 and nx ny nz 0), world, metres, in the vertex order of the skin
// that was bound. Buffers are sized on first use and then reused.
struct SkinFrame {
  std::vector<float> positions;  // #V x 4
  std::vector<float> normals;    // #V x 4, unit length

  // Working memory of the deformer; its content means nothing between frames.
  struct Scratch {
    std::vector<Transform> frames;
    std::vector<Quat> turns;
    std::vector<float> carriers, lifts, lifts_working, positions, normals;
    OwnElastic elastic;
  } scratch;
};

// Positions of a frame as doubles. `out` is resized once and then reused.
void to_points(const SkinFrame& frame, Points& out);

}  // namespace ecorche
