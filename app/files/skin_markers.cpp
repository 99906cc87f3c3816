#include "app/files/skin_markers.h"

#include <fmt/format.h>

#include "anatomy/base_mesh/base_skin.h"
#include "anatomy/errors.h"
#include "morph/measures/measure_table.h"

namespace ecorche {

std::vector<SkinMarker> skin_markers(const Assets& assets, const TriMesh& skin) {
  const BodyPackage package = read_body_package(assets);
  const std::optional<BaseSkin> base = find_base(assets, skin);
  if (!base && (skin.V.rows() != package.skin_size || skin.F.rows() != package.triangles.rows() ||
                skin.F != package.triangles))
    throw UnfitError(
        fmt::format("a skin of {} vertices has no landmarks: markers are known on the base mesh "
                    "and its fine one",
                    skin.V.rows()));
  std::vector<SkinMarker> out;
  const auto add = [&](const std::string& name, int vertex) {
    out.push_back({name, base ? base->refinement.base_rows[vertex] : vertex});
  };
  for (const SkinLandmark& landmark :
       read_measure_table(package, package.tables / "body").landmarks) {
    const int other = package.mirror[landmark.vertex];
    if (other == landmark.vertex) {
      add(landmark.id, landmark.vertex);
    } else {
      add(landmark.id + "_l", landmark.vertex);
      add(landmark.id + "_r", other);
    }
  }
  return out;
}

}  // namespace ecorche
