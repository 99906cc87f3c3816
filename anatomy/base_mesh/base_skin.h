// The base mesh that a refined skin comes from.
#pragma once

#include <optional>

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

}  // namespace ecorche::inline v1
