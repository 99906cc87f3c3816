// Ellipses through points of the plane.
#pragma once

#include <optional>
#include <span>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct Ellipse2 {
  Vec2 center = Vec2::Zero();
  Vec2 radii = Vec2::Zero();  // larger first
  double angle = 0;           // of the larger radius from +x, rad
};

// The direct least-squares ellipse (Fitzgibbon, Pilu, Fisher 1999, in the stable form of Halir and
// Flusser 1998). Nothing for fewer than five points, or points of a line or a single point.
std::optional<Ellipse2> fit_ellipse(std::span<const Vec2> points);

}  // namespace ecorche::inline v1
