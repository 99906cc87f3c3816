// A picture of all measurements on a body: tapes, callipers and sticks.
#pragma once

#include "morph/measures/tape_measure.h"
#include "viewer/gl/renderer.h"
#include "viewer/image.h"

namespace ecorche {

// Girths from the front, lengths and breadths from behind, heights from the side; each named
// beside the figure. `skin`: in the base mesh's topology.
Image sheet_of_tapes(Renderer& renderer, const TapeMeasure& tape, const TriMesh& skin,
                     int cell_width, int cell_height);

}  // namespace ecorche
