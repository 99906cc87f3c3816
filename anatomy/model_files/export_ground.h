// What an exported model stands on: a floor, and balls under the feet that meet it.
#pragma once

#include <string>
#include <vector>

#include "anatomy/model_files/model_export.h"

namespace ecorche::inline v1 {

// Sets model.ground and model.contacts: the floor at the lowest point of the skin; under each foot
// balls below heel, heads of the first and fifth metatarsal, base of the fifth, and toes. A ball
// fills the pad between bone and sole. Throws UnfitError for an anatomy without these bones.
void add_ground(const Anatomy& anatomy, const Body& body, ExportModel& model);

// Markers on the bones nearest to them. `places`: world at rest.
void add_markers(const Anatomy& anatomy, const std::vector<std::string>& names,
                 const Points& places, ExportModel& model);

}  // namespace ecorche::inline v1
