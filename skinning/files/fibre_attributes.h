// Private to the writers of .glb files: which way a muscle's fibres run, for those who shade them.
#pragma once

#include <span>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/skin_texture.h"
#include "anatomy/muscles/muscle_surface.h"

namespace ecorche::inline v1::gltf {

struct FibreAttributes {
  // #V x 2. u: across, from one edge of the section to the other, the same on its front and its
  // back, so that there is no seam; of a sheet across all its strips. v: along the line, 0 at the
  // origin, 1 at the insertion.
  TexturePoints places;
  Points directions;  // #V x 3, unit length, at rest, towards the insertion
};

// Of one muscle. slices: of all muscles at rest.
FibreAttributes fibre_attributes(const Muscle& muscle, const MuscleSurface& surface,
                                 const MuscleSurface::Part& part, std::span<const Ellipse> slices);

}  // namespace ecorche::inline v1::gltf
