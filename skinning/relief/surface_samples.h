// Points of muscles, tendons, fascia and bones that lie next to the skin. Private to the library.
//
// Chosen at rest: what a line to the skin reaches without meeting anything else. A frame moves them
// with muscles and bones.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "anatomy/muscles/fascia_surface.h"
#include "anatomy/muscles/muscle_surface.h"

namespace ecorche::inline v1 {

struct SurfaceSamples {
  // Pieces of muscle surfaces, posed side by side, and which of their vertices are samples.
  struct Piece {
    MuscleSurface surface;
    std::vector<int> sample;
    std::vector<float> dent;   // #sample, m, inward: tendinous intersections bind the surface down
    std::vector<float> belly;  // #sample, 1 on the belly, 0 on tendon
  };
  struct BoneSample {
    int joint = 0;
    Eigen::Vector3f at, normal;  // from the joint, world's axes at rest
  };
  std::vector<Piece> pieces;
  FasciaSurface fascia;
  std::vector<int> fascia_sample;
  std::vector<BoneSample> bones;
  std::size_t count = 0;
};

struct PosedSamples {
  std::vector<float> positions, normals;  // #samples x 4, world, m
  std::vector<PointsF> piece_positions, piece_normals;
  PointsF fascia_positions, fascia_normals;
};

// `rest`: the anatomy's rest pose; `skin`: over it.
SurfaceSamples sample_surfaces(const Anatomy& anatomy, const PosedAnatomy& rest,
                               const TriMesh& skin);

// `out` is sized once and then reused.
// `activation`: per muscle, empty: all relaxed. A tensed belly rises by up to kTensed.
void pose_samples(const SurfaceSamples& samples, const PosedAnatomy& posed,
                  std::span<const double> activation, PosedSamples& out);

// m, that a tensed muscle's belly stands out beyond what it swells: it gets hard, and what lies
// over it is drawn down beside it, not into it. Judged by eye.
constexpr float kTensed = 0.0006f;

}  // namespace ecorche::inline v1
