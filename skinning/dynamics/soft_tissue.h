// Secondary motion (jiggle): loose soft tissue lags behind the bones and settles.
//
// Every vertex of the mesh that relaxes is a damped oscillator about the place where the skeleton
// carries it, driven by that place's acceleration:
//   u'' + 2 z w u' + w^2 u = -a,   world axes.
// The softer the layer (the more tissue between skin and bone) the lower the frequency and the
// larger the fraction of u that is seen. The equation is solved exactly for an acceleration that is
// constant over a step, on a fixed grid of time that frames sample, over poses that a smooth curve
// joins: the frame rate does not matter. Off unless asked for.
//
// Tissue over an active muscle is stiffer and better damped (Wakeling & Nigg
// 2001, 10.1152/jappl.2001.90.2.412): at full activation the frequency is twice that of relaxed
// tissue and the damping 0.8 of critical instead of 0.3, in proportion between; the nearer the
// muscle is to the skin the more of that reaches it.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/binding.h"
#include "skinning/character/character_model.h"
#include "skinning/motion/activation.h"

namespace ecorche::inline v1 {

// The oscillators of a character; constant.
struct SoftTissueTables {
  struct Vertex {
    int place = 0;  // in the sorted order of the mesh that relaxes
    JointWeights joints;
    Vec3 rest = Vec3::Zero();    // world
    double gain = 0, limit = 0;  // fraction of u that is seen; its bound, m
    // One step: (u, v) -> (uu u + uv v + ua a, vu u + vv v + va a).
    double uu = 0, uv = 0, ua = 0, vu = 0, vv = 0, va = 0;
    double frequency = 0;  // Hz, relaxed
    // muscles that stiffen it, and the fraction of their activation that reaches it; 0 for none
    std::array<std::pair<int, double>, 3> muscles{};
  };
  int vertex_count = 0;          // of the mesh
  std::vector<Vertex> vertices;  // those that are loose
  std::vector<Vec3> origins;     // of the joints, rest
};

SoftTissueTables make_soft_tissue(const CharacterModel& model);

// The tissue at one time; begins at rest with the motion's first frame.
struct SoftTissueState {
  long long step = -1;                       // of the grid
  std::vector<Vec3> displacement, velocity;  // a loose vertex
  // the places that the skeleton gives it at step - 1, step, step + 1
  std::vector<Vec3> before, now, after;
  std::vector<float> offsets;  // of the mesh, #V x 4: FrameInputs::soft_tissue
  // Workspace: no meaning between calls.
  std::vector<Transform> X_WJ, bones;
  std::vector<double> activation;
  Pose pose;
};

// Advances to `time` (s from the first frame; never back) and fills state.offsets. `activations`:
// of the muscles; none: all are relaxed. Preconditions: the motion belongs to the skeleton and has
// frames. Throws std::invalid_argument for a time before the last one's step.
void advance_soft_tissue(const SoftTissueTables& tables, const Skeleton& skeleton,
                         const Motion& motion, const Activations& activations, double time,
                         SoftTissueState& state);

// The same from any time to any other, for windows in which people jump about: time that goes back
// or on by more than a second begins anew a second before; an oscillation falls to a thousandth in
// that time.
void seek_soft_tissue(const SoftTissueTables& tables, const Skeleton& skeleton,
                      const Motion& motion, const Activations& activations, double time,
                      SoftTissueState& state);

}  // namespace ecorche::inline v1
