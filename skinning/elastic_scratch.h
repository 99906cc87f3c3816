// Working memory of the elastic skin, which every frame owns; its content means nothing between frames. Private to the room.
#pragma once

#include <memory>
#include <vector>

namespace ecorche {

struct ElasticSkin;
class ContactTree;

struct MembraneScratch {
  // Whole fours of vertices x 4.
  std::vector<float> turns;                     // quaternions
  std::vector<float> places, offsets, normals;
  std::vector<float> pull;                      // sum of c (a_i - a_j) of the anchors a, component by component
  std::vector<float> right;                     // #V x 4, in the factor's order
};

// The tree of one posed skin, refitted to each pose. A copied frame builds one of its own.
struct OwnTree {
  OwnTree() = default;
  OwnTree(OwnTree&&) = default;
  OwnTree& operator=(OwnTree&&) = default;
  OwnTree(const OwnTree&) {}
  OwnTree& operator=(const OwnTree&) {
    tree.reset();
    return *this;
  }

  std::shared_ptr<ContactTree> tree;
};

struct ContactScratch {
  OwnTree own;                                // of one mesh: forget it before another one's turn
  std::vector<float> pushes, spread, before;  // #V x 4
  std::vector<char> wanted;                   // #V: which are looked at
};

struct ElasticScratch {
  std::shared_ptr<const ElasticSkin> skin;    // whose contact tree it is
  MembraneScratch membrane;
  ContactScratch contact;
  std::vector<float> normals, open, working;
  std::vector<float> base, offsets;           // of a refined skin's base mesh
};

}  // namespace ecorche
