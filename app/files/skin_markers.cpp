#include "app/files/skin_markers.h"

#include <fmt/format.h>

#include "anatomy/base_mesh/base_skin.h"
#include "anatomy/errors.h"
#include "morph/measures/measure_table.h"

namespace ecorche {

namespace {

int nearest_vertex(const Points& V, const Eigen::RowVector3d& place) {
  Eigen::Index out = 0;
  (V.rowwise() - place).rowwise().squaredNorm().minCoeff(&out);
  return int(out);
}

}  // namespace

std::vector<SkinMarker> skin_markers(const Assets& assets, const Character& character) {
  const TriMesh& skin = character.body.skin;
  const BodyPackage package = read_body_package(assets);
  const OwnSkin* own = character.own.get();
  const std::optional<BaseSkin> base = own ? std::nullopt : find_base(assets, skin);
  if (!own && !base &&
      (skin.V.rows() != package.skin_size || skin.F.rows() != package.triangles.rows() ||
       skin.F != package.triangles))
    throw UnfitError(
        fmt::format("a skin of {} vertices has no landmarks: markers are known on the base mesh "
                    "and its fine one",
                    skin.V.rows()));
  std::vector<SkinMarker> out;
  for (const auto& [name, vertex] :
       landmark_vertices(package, read_measure_table(package, package.tables / "body")))
    out.push_back({name, own    ? nearest_vertex(skin.V, own->base.V.row(vertex))
                         : base ? base->refinement.base_rows[vertex]
                                : vertex});
  return out;
}

}  // namespace ecorche
