#include "anatomy/muscles/thinned_fascia.h"

#include <algorithm>
#include <cmath>

namespace ecorche::inline v1 {
namespace {

constexpr int kLeastOfSleeve = 7;  // columns around a joint

// Which of `count` rows, `length` m apart from first to last.
std::vector<int> kept_of(int count, double length, double side, int least) {
  const int wanted = std::clamp(1 + int(std::lround(length / side)), std::min(least, count), count);
  std::vector<int> out;
  for (int k = 0; k < wanted; ++k)
    out.push_back(int(std::lround(double(k) * (count - 1) / (wanted - 1))));
  return out;
}

void take_point(const FasciaSurface& surface, const FasciaSurface::Part& part, int point,
                FasciaSurface& out) {
  append_point(surface, point, out);
  const auto pushes = surface.clearances.begin() + part.push_begin +
                      long(part.reaches.size()) * (point - part.vertex_begin);
  out.clearances.insert(out.clearances.end(), pushes, pushes + long(part.reaches.size()));
}

}  // namespace

FasciaSurface thinned_fascia(const FasciaSurface& surface, double side) {
  FasciaSurface out;
  out.term_begin.push_back(0);
  out.reaches = surface.reaches;
  out.slices = surface.slices;
  for (const FasciaSurface::Part& part : surface.parts) {
    const std::size_t last = std::size_t(part.vertex_end) - 1;
    const std::vector<int> rows = kept_of(part.rows, surface.along[last], side, 2),
                           columns = kept_of(part.columns, surface.across[last], side,
                                             part.sleeve ? kLeastOfSleeve : 2);
    FasciaSurface::Part& thin = out.parts.emplace_back(part);
    thin.rows = int(rows.size());
    thin.columns = int(columns.size());
    thin.vertex_begin = out.vertices();
    thin.push_begin = int(out.clearances.size());
    for (const int r : rows)
      for (const int c : columns)
        take_point(surface, part, part.vertex_begin + r * part.columns + c, out);
    thin.vertex_end = out.vertices();
  }
  triangulate(out);
  return out;
}

}  // namespace ecorche::inline v1
