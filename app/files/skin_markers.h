// Named points of the skin: the landmarks of data/body/landmarks.csv on both sides, as markers of
// motion tables and exported models.
#pragma once

#include <string>
#include <vector>

#include "anatomy/character.h"
#include "anatomy/files/assets.h"

namespace ecorche {

struct SkinMarker {
  std::string name;  // "acromion_l"; without side on the mid-plane
  int vertex = 0;    // of the skin
};

// Of a skin of the character's own: its vertices that are nearest at rest. Throws UnfitError for
// another skin that is not the body package's base mesh or its fine one, InputError without the
// package.
std::vector<SkinMarker> skin_markers(const Assets& assets, const Character& character);

}  // namespace ecorche
