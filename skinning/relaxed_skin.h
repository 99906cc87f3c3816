// The skin of one frame on its way from the blend to its final shape.
#pragma once

#include <vector>

namespace ecorche::inline v1 {

// Of the mesh that relaxes: the skin itself in the sorted order of its tables, or the base mesh of
// a refined skin. Each stage of a frame reads here what stages before it have written.
struct RelaxedSkin {
  std::vector<float> positions, normals;  // #V x 4
  // #V: 1 where tissue is free to swell, falling to 0 in folds, where it would press into itself.
  // Written by find_openness(), lowered where contact or muscles hold the skin.
  std::vector<float> openness;
  std::vector<float> liftable;  // #V: how freely muscles may lift the skin, 0 .. 1
  std::vector<char> pressed;  // #V: whether self-contact has moved it so far that it holds muscles
};

}  // namespace ecorche::inline v1
