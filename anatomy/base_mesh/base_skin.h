// The base mesh that a refined skin comes from.
#pragma once

#include <optional>

#include "anatomy/character.h"
#include "anatomy/files/assets.h"
#include "anatomy/geometry/subdivide.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

// A refined skin is bound and relaxed by way of its base mesh.
struct BaseSkin {
  TriMesh mesh;
  Refinement refinement;
};

// The base mesh of a skin that is the body package's fine one in any shape; none for other skins or
// without the package.
std::optional<BaseSkin> find_base(const Assets& assets, const TriMesh& skin);

// The same for a character, whose own skin may be any mesh: then the base mesh that it hangs on;
// its refinement knows no `parents` and no `base_rows`.
std::optional<BaseSkin> find_base(const Assets& assets, const Character& character);

}  // namespace ecorche::inline v1
