// Working memory of the stages on the relaxing skin. Sized on first use; its content means nothing
// between calls. Private to the library.
#pragma once

#include <array>
#include <vector>

#include "anatomy/compute/simd.h"

namespace ecorche::inline v1 {

struct MembraneWorkspace {
  // Whole eights of vertices x 4.
  std::vector<float> rotations;  // quaternions
  std::vector<float> places, offsets, normals, half;
  std::vector<float> pull;   // sum of c (a_i - a_j) of the anchors a, component by component
  std::vector<float> right;  // #V x 4, in the factor's order
};

struct PatchWorkspace {
  struct Shape {
    float low[4] = {}, high[4] = {};  // of the box
    float middle[4] = {}, up[4] = {};
    float reach = 0;            // m
    float spread = 0;           // cosine of the largest angle of a normal with `up`
    float facing = 1;           // its sine, or 1: what is further along `up` than that is not faced
    float bottom = 0, top = 0;  // m, along `up`
  };
  // Boxes of eight patches, and shapes of eight parts of one patch, component by component.
  struct EightBoxes {
    std::array<Float8, 3> low, high;
    Float8 reach;
  };
  struct EightParts {
    std::array<Float8, 3> low, high, up;
    Float8 facing, bottom, top;
  };
  std::vector<Shape> shapes;  // a patch
  std::vector<EightBoxes> boxes;
  std::vector<EightParts> parts;
  std::vector<char> met;  // a patch: whether a vertex of it is in contact, perhaps
};

struct SelfContactWorkspace {
  PatchWorkspace patches;
  std::vector<float> boxes;                         // of the tree of triangles, fitted to the pose
  std::vector<float> pushes, spread, before, half;  // #V x 4
  std::vector<char> wanted;  // #V: candidates; then, vertices that are pushed
  std::vector<int> pushed;   // those, and the rings about them
  std::vector<char> turned;  // #V: vertices whose normals change with those that are pushed
  std::vector<int> turning;  // those
};

struct SettleWorkspace {
  MembraneWorkspace membrane;
  SelfContactWorkspace contact;
  std::vector<float> half;       // of vertex normals
  std::vector<float> smoothing;  // #V
  std::vector<float> folded;     // #V m, by how much folds have pressed a vertex
};

}  // namespace ecorche::inline v1
