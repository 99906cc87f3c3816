// Bellies at their rest volumes again after sections or their outlines have been moved. For pose_anatomy and what comes after it.
#pragma once

#include <span>

#include "anatomy/posing_lanes.h"
#include "anatomy/posing_table.h"

namespace ecorche {

// Strips of which a section has `changed` (#sections) swell or shrink until they have their rest volumes.
void regrow(const PosingTable::Data& data, std::span<const char> changed, PosedAnatomy& out);

// Strips of a batch that no growth found for them gives their rest volume: their outlines become more even (round_out).
void round_out_missed(const PosingTable::Data& data, const PosingBatch& batch, const LaneGrowth& found, PosedAnatomy& out);

}  // namespace ecorche
