// The outline of a plane's cut through a mesh, as rays from a point inside of it see it, and the
// section that holds it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/geometry/mesh_sections.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

// A plane with a frame in it.
struct CutPlane {
  Vec3 point, u, v, normal;  // u, v, normal: right-handed, orthonormal
  Vec3 at(const Vec2& p) const { return point + p.x() * u + p.y() * v; }
};

// What rays of even angles found; in the plane's frame.
struct SectionOutline {
  std::vector<std::array<Vec2, 2>> cuts;  // the section itself
  Vec2 from = Vec2::Zero();               // where the rays begin
  std::vector<Vec2> points;               // where each left the section for the last time
  int missed = 0;                         // rays that met nothing
  double area = 0;                        // enclosed: bays and holes taken off, m^2
  double star_area = 0;                   // of the polygon through the points
  Vec2 centroid = Vec2::Zero();           // of that polygon
  // share of the rays' length that lies beyond their first crossing: 0 where all of the outline is
  // seen
  double hidden = 0;
};

// From the section's middle, or, where bays hide part of the outline from there, from the point
// inside that sees most of it.
SectionOutline outline_of(const CutPlane& plane, const Section& section, int rays);

// A section a plane: an ellipse by direct least squares, in a frame that turns smoothly along the
// line, with an outline (anatomy.h) that follows the points; its area is the outline's. Nothing
// where more than half of the rays missed or no ellipse passes the points.
std::vector<std::optional<Ellipse>> outlined_sections(std::span<const CutPlane> planes,
                                                      std::span<const SectionOutline> outlines);

}  // namespace ecorche::inline v1
