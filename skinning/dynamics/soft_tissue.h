// Secondary motion: loose flesh lags behind the bones and settles.
//
// Every vertex of the sheet is a damped oscillator about the place where the skeleton carries it,
// driven by that place's acceleration:
//   u'' + 2 z w u' + w^2 u = -a,   world axes.
// The softer the layer (the more lies between skin and bone) the lower the frequency and the larger
// the share of u that is seen. The equation is solved exactly for an acceleration that is constant
// over a step, on a fixed grid of time of which a film's frames are merely looked at, over poses
// that a smooth curve joins: the rate of the film does not matter. Off unless asked for.
//
// Flesh over a working muscle is stiffer and better damped (Wakeling & Nigg
// 2001, 10.1152/jappl.2001.90.2.412): at full effort the frequency is twice that of relaxed flesh
// and the damping 0.8 of critical instead of 0.3, in proportion between; the nearer the muscle lies
// under the skin the more of that reaches it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/bind/bind.h"
#include "skinning/motion/activation.h"
#include "skinning/skin_frame.h"

namespace ecorche {

// What moves how; made once a binding.
struct FleshTables {
  struct Vertex {
    int place = 0;  // in the sheet's order
    std::array<Influence, 4> joints;
    Vec3 rest = Vec3::Zero();    // world
    double gain = 0, limit = 0;  // share of u that is seen; m, that it does not exceed
    // One step: (u, v) -> (uu u + uv v + ua a, vu u + vv v + va a).
    double uu = 0, uv = 0, ua = 0, vu = 0, vv = 0, va = 0;
    double frequency = 0;  // Hz, relaxed
    std::array<std::pair<int, double>, 3>
        // that stiffen it, and how much of their effort reaches it; 0 for those that are none
        muscles{};
  };
  int vertex_count = 0;          // of the sheet
  std::vector<Vertex> vertices;  // those that are loose
  std::vector<Vec3> origins;     // of the joints, rest
};

// Empty for a binding that is not elastic.
FleshTables make_flesh_tables(const Binding& binding, const Anatomy& anatomy);

// Where the flesh is; begins at rest with the motion's first frame.
struct FleshState {
  long long step = -1;                 // of the grid
  std::vector<Vec3> offset, velocity;  // a loose vertex
  std::vector<Vec3> before, now,
      after;  // the places that the skeleton gives it at step - 1, step, step + 1
  std::vector<Transform> X_WJ, bones;  // working memory
  std::vector<double> efforts;
  std::vector<float> seen;  // of the sheet x 4: what deform_skin() takes
};

// Goes on to `time` (s from the first frame; never back) and fills state.seen. `efforts`: of the
// muscles, none: all are relaxed. Preconditions: the motion belongs to the skeleton and has frames.
// Throws std::invalid_argument for a time before the last one's step.
void move_flesh(const FleshTables& tables, const Skeleton& skeleton, const Motion& motion,
                const Activations& efforts, double time, FleshState& state);

// The same from anywhere to anywhere, for windows in which people jump about: time that goes back
// or on by more than a second begins anew a second before, after which all but a thousandth of an
// oscillation has died away.
void seek_flesh(const FleshTables& tables, const Skeleton& skeleton, const Motion& motion,
                const Activations& efforts, double time, FleshState& state);

// deform_skin() with flesh that lags: `flesh` is state.seen; empty: not at all. Ignored by a
// binding that is not elastic.
void deform_skin(const Binding& binding, const PosedAnatomy& posed, std::span<const float> flesh,
                 SkinFrame& out);

}  // namespace ecorche
