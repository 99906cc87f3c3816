// Relief of the anatomy on the skin of the lean: muscles, tendons and bones stand out as the layer
// over them is thin, and as they swell.
//
// Beneath each vertex the depth of the anatomy is measured (sample_depths.h), split into bands of
// wavelengths (skin_smoothing.h), and what a layer of that thickness lets through is shown
// (layer_filter.h). Superficial veins are ridges of their own (vein_ridges.h), higher in effort.
// Vertices move along their normals, by some millimetres at most and the less the thinner the body
// is there; not on the head, whose skin has its own form, and not in folds. The mean of that over a
// region of kShape is zero, so that volumes stay. Where a whole belly swells the skin follows, so
// that the layer over it stays as thick as it is at rest. A function of skin and muscles of the
// frame alone, continuous in both.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "anatomy/geometry/subdivide.h"
#include "anatomy/posed_anatomy.h"
#include "anatomy/vein_path.h"
#include "skinning/binding.h"
#include "skinning/relief/sample_depths.h"
#include "skinning/skin_frame.h"

namespace ecorche::inline v1 {

struct ReliefTables;  // skin_relief.cpp

struct SkinRelief {
  std::shared_ptr<const ReliefTables> data;  // null: none

  bool empty() const { return data == nullptr; }
};

struct ReliefOptions {
  double definition = 0;  // 0 none .. 1 all that the layer lets through
  // m, median thickness of fat and skin that the body has by its fat. Layers are taken to be as
  // much thinner as the anatomy lies deeper than that, which a fit may put deeper than it is in
  // the lean. 0: layers as they are measured.
  double layer = 0;
  std::span<const VeinPath> veins{};
};

// All that a fine skin is made of, at rest.
struct ReliefSkin {
  const TriMesh& fine;
  const TriMesh& base;
  const Refinement& refinement;                 // of the base mesh
  std::span<const JointWeights> joint_weights;  // of the fine skin
};

// Empty for a definition of 0. `rest`: the anatomy's rest pose.
SkinRelief make_skin_relief(const Anatomy& anatomy, const PosedAnatomy& rest,
                            const ReliefSkin& skin, const ReliefOptions& options);

struct ReliefWorkspace {
  PosedSamples samples;
  SampleGrid grid;
  std::vector<float> depth, fine, moved, half;
  std::vector<float> band, wider, sum, shape;
  std::vector<float> openness;  // in, #base vertices: 0 in folds .. 1; empty: no folds
  std::vector<float> relief;    // out, #V m, outward: as the skin was moved
};

// Moves the skin of a frame over its posed muscles; positions and normals. `activation`: per
// muscle, 0 relaxed .. 1; empty: all relaxed. What is tensed stands out more, and so do all veins.
// Throws std::invalid_argument for an empty relief, and for skin or slices of other size than it
// was made of.
void add_relief(const SkinRelief& relief, const PosedAnatomy& posed,
                std::span<const double> activation, SkinFrame& skin, ReliefWorkspace& workspace);

// Height of the veins' ridges at each vertex, m, at full effort; empty where there are none.
std::span<const float> vein_heights(const SkinRelief& relief);

}  // namespace ecorche::inline v1
