// Appearance of a character in files, beside its anatomy: texture coordinates, eyes, cartilage.
#pragma once

#include <vector>

#include "anatomy/base_mesh/eyes.h"
#include "anatomy/base_mesh/skin_texture.h"
#include "anatomy/bones/cartilage.h"
#include "anatomy/files/assets.h"

namespace ecorche::inline v1 {

struct CharacterLook {
  SkinTexture texture;  // of the skin that is written; empty where it is not the body package's
  std::vector<Eyeball> eyes;
  std::vector<CartilageRule> cartilage;  // where bones are drawn as cartilage
};

// Of a skin that is the package's base mesh or its fine one, in any shape; without texture and eyes
// for another. Takes a second for the fine one.
CharacterLook find_look(const BodyPackage& package, const TriMesh& skin, const Skeleton& skeleton);

// The same with the package that is installed; without texture and eyes where there is none.
CharacterLook find_look(const Assets& assets, const TriMesh& skin, const Skeleton& skeleton);

}  // namespace ecorche::inline v1
