#include "skinning/files/character_look.h"

#include "anatomy/base_mesh/refined_skin.h"
#include "anatomy/errors.h"

namespace ecorche::inline v1 {

CharacterLook find_look(const BodyPackage& package, const TriMesh& skin, const Skeleton& skeleton) {
  const std::vector<CartilageRule> cartilage = read_cartilage_rules(package.tables);
  const auto is = [&](Eigen::Index vertices, const Triangles& F) {
    return skin.V.rows() == vertices && skin.F.rows() == F.rows() && skin.F == F;
  };
  if (is(package.skin_size, package.triangles))
    return {skin_texture(package), find_eyes(package, skin, skeleton), cartilage};
  if (skin.F.rows() != 9 * package.triangles.rows()) return {{}, {}, cartilage};
  const Refinement fine = refine_skin(package);
  if (!is(fine.map.rows(), fine.F)) return {{}, {}, cartilage};
  TriMesh base{Points(package.skin_size, 3), package.triangles};
  for (int i = 0; i < package.skin_size; ++i) base.V.row(i) = skin.V.row(fine.base_rows[i]);
  return {skin_texture(skin_texture(package), fine), find_eyes(package, base, skeleton), cartilage};
}

CharacterLook find_look(const Assets& assets, const TriMesh& skin, const Skeleton& skeleton) {
  try {
    return find_look(read_body_package(assets), skin, skeleton);
  } catch (const InputError&) {
    return {{}, {}, read_cartilage_rules(assets.tables)};
  }
}

}  // namespace ecorche::inline v1
