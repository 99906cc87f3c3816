// Working memory of the collision of muscles and skin. Sized on first use; its content means
// nothing between calls. Private to the library.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/contact/muscle_contact.h"
#include "anatomy/posing/restore_volume.h"

namespace ecorche::inline v1 {

// A point of a muscle or bone against the skin.
struct SkinPenetration {
  int vertex = 0;   // of the skin, nearest
  float depth = 0;  // m, by which it is out of the skin; negative below
};

// Displacement of a section that must give way to the skin.
struct SectionResponse {
  Vec3 way = Vec3::Zero();  // inward, of the section as a whole
  RadialSamples press{};    // of its outline, as fractions of the radii
  bool any = false;
};

struct LiftWorkspace {
  std::vector<float> lift, before;                     // #V, m
  std::vector<char> met;                               // #V
  std::vector<int> vertices;                           // candidates
  std::vector<float> normals, half;                    // #V x 4
  std::vector<SkinPenetration> penetrations;           // eight an owner; then, those near the skin
  std::vector<unsigned char> penetration_count;        // #owners
  std::vector<float> rise, most, unraised;             // of raise_skin(): #V, #V, #V x 4
  std::vector<std::vector<SkinPenetration>> of_bones;  // a block of probes each
};

struct PushWorkspace {
  std::vector<char> near;                  // #owners: whether a section is examined
  std::vector<SectionResponse> responses;  // #owners
  std::vector<Ellipse> examined;           // #owners: sections as they were in the first round
  std::vector<Vec3> ways;                  // #sections
  std::vector<char> changed;               // #sections
  std::vector<RadialSamples> held;         // #sections: growth that the skin blocks, 0 .. 1
  VolumeWorkspace volumes;
  ContactState contact_state;  // from the first round of a call to the second
  ContactWorkspace contact;
};

}  // namespace ecorche::inline v1
