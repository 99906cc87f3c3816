// Where the skin lies on a texture: the base mesh's own layout, for painted skins.
//
// A vertex on a seam has a place on either side of it, and file formats with one place a vertex
// split it. The first #V textured vertices are the skin's own, in its order; what seams need beyond
// them follows. A cache of the skin's vertices therefore gives the textured ones by `vertex`.
#pragma once

#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/geometry/subdivide.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

using TexturePoints = Eigen::Matrix<float, Eigen::Dynamic, 2,
                                    Eigen::RowMajor>;  // right and up, (0, 0) at the lower left

struct SkinTexture {
  std::vector<int>
      vertex;  // #T: the skin's vertex, vertex[i] = i for i < #V; empty: no texture is known
  TexturePoints places;  // #T x 2
  Triangles F;           // #F x 3 over the textured vertices, the skin's triangles in order
  bool empty() const { return vertex.empty(); }
};

// Of the base mesh. Throws InputError for a package whose mesh file is damaged or has no texture
// places.
SkinTexture skin_texture(const BodyPackage& package);

// Of the fine skin: edges are cut in three and triangles have a vertex in the middle, on the
// texture as on the skin. Precondition: `refinement` is one round of refine() on the base mesh that
// `base` belongs to, closed; reordered or not.
SkinTexture skin_texture(const SkinTexture& base, const Refinement& refinement);

// Rows of the skin's vertices as the textured ones need them.
Points textured_rows(const SkinTexture& texture, const Points& skin);

}  // namespace ecorche::inline v1
