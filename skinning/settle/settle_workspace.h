// Working memory of the elastic skin, which every frame owns; its content means nothing between
// frames. Private to the room.
#pragma once

#include <array>
#include <vector>

#include "anatomy/compute/simd.h"

namespace ecorche {

struct MembraneScratch {
  // Whole eights of vertices x 4.
  std::vector<float> turns;  // quaternions
  std::vector<float> places, offsets, normals, half;
  std::vector<float> pull;   // sum of c (a_i - a_j) of the anchors a, component by component
  std::vector<float> right;  // #V x 4, in the factor's order
};

struct PatchScratch {
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
  std::vector<char> met;  // a patch: whether a vertex of it is to be looked at
};

struct ContactScratch {
  PatchScratch patches;
  std::vector<float> boxes;                         // of the tree of triangles, fitted to the pose
  std::vector<float> pushes, spread, before, half;  // #V x 4
  std::vector<char> wanted;  // #V: which are looked at; then, which are pushed
  std::vector<int> pushed;   // those, and the rings about them
  std::vector<char> turned;  // #V: whose normals change with those that are pushed
  std::vector<int> turning;  // those
};

struct ElasticScratch {
  MembraneScratch membrane;
  ContactScratch contact;
  std::vector<float> normals, half, open, working, rising;
  std::vector<char> pressed;         // #V: whether contact has moved it
  std::vector<float> base, offsets;  // of a refined skin's base mesh
};

}  // namespace ecorche
