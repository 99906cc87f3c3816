#include "skinning/files/fibre_attributes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace ecorche::inline v1::gltf {
namespace {

// A share of a turn as one way there and the same way back.
double folded(double turn) {
  turn -= std::floor(turn);
  return turn <= 0.5 ? 2 * turn : 2 - 2 * turn;
}

}  // namespace

FibreAttributes fibre_attributes(const Muscle& muscle, const MuscleSurface& surface,
                                 const MuscleSurface::Part& part, std::span<const Ellipse> slices) {
  const int count = part.vertex_end - part.vertex_begin;
  std::size_t rows = 2;
  for (const Strip& strip : muscle.strips) rows = std::max(rows, strip.slices.size());
  // A sheet is loops of this many vertices, one a row and one more at either end. They begin a
  // quarter of an outline before the last strip's edge.
  const int loop = std::max(1, count / (int(rows) + 2));
  FibreAttributes out{TexturePoints(count, 2), Points(count, 3)};
  for (int i = 0; i < count; ++i) {
    const std::size_t v = std::size_t(part.vertex_begin + i);
    const double turn = part.sheet ? double(i % loop - kOutlinePoints / 4) / loop
                                   : double(surface.angle[v]) / (2 * std::numbers::pi);
    out.places.row(i) << folded(turn), double(surface.along[v]);
    out.directions.row(i) = slices[std::size_t(surface.slice[v])].axes.col(2).transpose();
  }
  return out;
}

}  // namespace ecorche::inline v1::gltf
