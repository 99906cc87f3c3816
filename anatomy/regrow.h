// Bellies at their rest volumes again after outlines have changed. Private to pose_anatomy.
#pragma once

#include <span>

#include "anatomy/posing_table.h"

namespace ecorche {

// Strips of which a section has `changed` (#sections) swell or shrink until they have their rest volumes.
void regrow(const PosingTable::Data& data, std::span<const char> changed, PosedAnatomy& out);

}  // namespace ecorche
