// What a character's file shows beside the anatomy: where its skin lies on a texture, and its eyes.
#pragma once

#include <vector>

#include "anatomy/base_mesh/eyes.h"
#include "anatomy/base_mesh/skin_texture.h"

namespace ecorche {

struct CharacterLook {
  SkinTexture texture;  // of the skin that is written; empty where it is not the body package's
  std::vector<Eyeball> eyes;
};

// Of a skin that is the package's base mesh or its fine one, in any shape; empty for another. Takes
// a second for the fine one.
CharacterLook find_look(const BodyPackage& package, const TriMesh& skin, const Skeleton& skeleton);

// The same with the package that is installed; empty where there is none.
CharacterLook find_look(const TriMesh& skin, const Skeleton& skeleton);

}  // namespace ecorche
