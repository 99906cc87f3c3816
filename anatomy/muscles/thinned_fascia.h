// Sheets of fascia with fewer rows and columns, for pictures of what moves.
#pragma once

#include "anatomy/muscles/fascia_surface.h"

namespace ecorche::inline v1 {

// The same sheets in the same order with those rows and columns alone that lie about `side` apart,
// m: the outermost and others evenly between them. What is left goes as it did, but for heights
// over muscles, which are those that the points left ask for.
FasciaSurface thinned_fascia(const FasciaSurface& surface, double side);

}  // namespace ecorche::inline v1
