#include "anatomy/base_mesh/base_skin.h"

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/base_mesh/refined_skin.h"
#include "anatomy/errors.h"

namespace ecorche::inline v1 {

std::optional<BaseSkin> find_base(const Assets& assets, const TriMesh& skin) try {
  constexpr Eigen::Index kFine = 100000;
  if (skin.V.rows() < kFine) return std::nullopt;
  const BodyPackage package = read_body_package(assets);
  BaseSkin base{{Points(package.skin_size, 3), package.triangles}, refine_skin(package)};
  const Triangles& F = base.refinement.F;
  if (base.refinement.map.rows() != skin.V.rows() || F.rows() != skin.F.rows() || F != skin.F)
    return std::nullopt;
  for (int i = 0; i < package.skin_size; ++i)
    base.mesh.V.row(i) = skin.V.row(base.refinement.base_rows[i]);
  return base;
} catch (const InputError&) {
  return std::nullopt;
}

std::optional<BaseSkin> find_base(const Assets& assets, const Character& character) {
  if (!character.own) return find_base(assets, character.body.skin);
  return BaseSkin{character.own->base, {character.own->map, character.body.skin.F, {}, {}}};
}

}  // namespace ecorche::inline v1
