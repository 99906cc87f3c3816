// Areas of outlines and their factors between the given directions.
//
// An outline is drawn as the polygon through its points. Areas are the polygon's, over that of the
// polygon of the ellipse itself: so they are 1 for an ellipse, and a drawn muscle's volume is the
// same share of its true one whatever its shape.
#pragma once

#include <array>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// The factor at an angle in units of 2 pi / kOutlinePoints, 0 <= place < kOutlinePoints: linear
// between.
inline double outline_factor(const SliceOutline& outline, double place) {
  const int i = int(place), next = i + 1 < kOutlinePoints ? i + 1 : 0;
  const double share = place - i;
  return (1 - share) * double(outline[i]) + share * double(outline[next]);
}

// cos and sin of an outline's directions.
const std::array<Vec2, kOutlinePoints>& outline_directions();

// The outline of the same section where the axes point the other way.
SliceOutline flipped_outline(const SliceOutline& outline, bool width, bool thickness);

// Area over that of the ellipse.
double outline_area(const SliceOutline& outline);

// Areas of a piece between two sections with the axes a0, b0 and a1, b1 (each times its radius). T:
// of one piece, or of several at once.
template <class T>
struct AreasOf {
  T own;  // of the first, over that of its ellipse

  // Mixed area, over pi: half of
  //   ab (a0 x b1) + ba (a1 x b0) + aa (a0 x a1) + bb (b0 x b1).
  // The section at a share t between the two has the area  (1 - t)^2 A00 + 2 t (1 - t) A01 + t^2
  // A11.
  T ab, ba, aa, bb;

  // Volume of a piece beyond centre line times area, which sections that are not centrally
  // symmetric add as they turn and swell along it: pi / 3 times
  //   a1 a1 . (a0 x b0) + b1 b1 . (a0 x b0) - a0 a0 . (a1 x b1) - b0 b0 . (a1 x b1),
  // the factor (more_a1 ..) first, the vector after it. From the volume's integral over rings, 1/3
  // the triple product of a section, its change along the piece and its change around, which
  // vanishes for centrally symmetric sections.
  T more_a1, more_b1, more_a0, more_b0;
};

// Of two successive sections.
using PieceAreas = AreasOf<double>;
PieceAreas piece_areas(const SliceOutline& first, const SliceOutline& second);

}  // namespace ecorche::inline v1
