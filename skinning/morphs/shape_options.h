// How close shapes come to a motion.
#pragma once

namespace ecorche::inline v1 {

struct ShapeOptions {
  // What dropping shapes may leave: `error` but in a share of all places (vertices in frames), and
  // `worst` there; m. Smaller: more shapes.
  double error = 1e-3, share = 0.01, worst = 8e-3;
  double least = 3e-4;  // m, of any vertex: what a frame may leave before another shape is made
  int most = 64;        // shapes, whatever they leave
};

}  // namespace ecorche::inline v1
