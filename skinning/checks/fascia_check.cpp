#include "skinning/checks/fascia_check.h"

#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kDeep = 1e-3;  // m
constexpr int kMargin = 2;      // cells from an edge that is tucked in

}  // namespace

FasciaFigures measure_fascia(const Anatomy& anatomy, const FasciaSurface& surface, const Points& at,
                             const TriMesh& skin, const TriMesh& muscles) {
  FasciaFigures out;
  out.points = surface.vertices();
  if (out.points == 0 || muscles.F.rows() == 0) return out;
  const std::vector<int> in_skin = winding_numbers(skin, at),
                         in_muscle = winding_numbers(muscles, at);
  const NearestSurface nearest(muscles);
  for (const FasciaSurface::Part& part : surface.parts) {
    const FasciaSheet& sheet = anatomy.fascia[part.sheet];
    for (int i = part.vertex_begin; i < part.vertex_end; ++i) {
      out.outside += in_skin[i] == 0;
      const int from_edge =
          cells_from_edge(sheet.rows, sheet.columns, i - part.vertex_begin, is_sleeve(sheet));
      if (from_edge < kMargin || in_muscle[i] == 0) continue;
      out.pierced += nearest.nearest(at.row(i)).distance > kDeep;
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
