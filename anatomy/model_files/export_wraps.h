// Private to the writers of models: where along a straight-lined path an object lies that the path
// slides over.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "anatomy/model_files/model_export.h"

namespace ecorche::inline v1 {

struct PlacedWrap {
  std::size_t gap = 1;  // between the path's points gap - 1 and gap
  // the point of the line between them that comes nearest to the object's surface, or deepest,
  // world at rest
  Vec3 near = Vec3::Zero();
  Vec3 along = Vec3::UnitY();  // the line's direction there
};

// origins: of the model's bodies, world at rest.
PlacedWrap place_wrap(const ExportStrip& strip, const Wrap& wrap, const std::vector<Vec3>& origins);

// The sphere that an ellipsoid is like where the line passes: it touches it there and bends the
// line by as much. Where the line at rest lies within the ellipsoid the sphere keeps as far below.
// Nothing where that leaves no sphere.
std::optional<Wrap> osculating_sphere(const Wrap& ellipsoid, const PlacedWrap& placed);

// Of each body, world at rest.
std::vector<Vec3> origins_of(const ExportModel& model);

}  // namespace ecorche::inline v1
