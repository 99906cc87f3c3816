#include "skinning/files/character_look.h"

#include "anatomy/errors.h"

namespace ecorche {

CharacterLook find_look(const BodyPackage& package, const TriMesh& skin, const Skeleton& skeleton) {
  const auto is = [&](Eigen::Index vertices, const Triangles& F) {
    return skin.V.rows() == vertices && skin.F.rows() == F.rows() && skin.F == F;
  };
  if (is(package.skin_size, package.triangles))
    return {skin_texture(package), find_eyes(package, skin, skeleton)};
  if (skin.F.rows() != 9 * package.triangles.rows()) return {};
  const Refinement fine = refine_skin(package);
  if (!is(fine.map.rows(), fine.F)) return {};
  TriMesh base{Points(package.skin_size, 3), package.triangles};
  for (int i = 0; i < package.skin_size; ++i) base.V.row(i) = skin.V.row(fine.base_rows[i]);
  return {skin_texture(skin_texture(package), fine), find_eyes(package, base, skeleton)};
}

CharacterLook find_look(const TriMesh& skin, const Skeleton& skeleton) {
  try {
    return find_look(read_body_package(find_packages()), skin, skeleton);
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace ecorche
