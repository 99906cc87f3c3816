// Whether sheets of fascia stay between skin and muscles.
#pragma once

#include "anatomy/muscles/fascia_surface.h"

namespace ecorche::inline v1 {

struct FasciaFigures {
  int points = 0;
  int outside = 0;  // of the skin
  int pierced = 0;  // more than a millimetre within a muscle, but for points near a sheet's edge
};

// `at`: the surface's points, at rest or posed; `skin`, closed, and `muscles` in the same pose.
FasciaFigures measure_fascia(const Anatomy& anatomy, const FasciaSurface& surface, const Points& at,
                             const TriMesh& skin, const TriMesh& muscles);

}  // namespace ecorche::inline v1
