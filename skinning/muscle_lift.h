// Nodes on the skin that keep their height over the muscles beneath. Private to the room.
#pragma once

#include <vector>

#include "anatomy/pose_anatomy.h"
#include "skinning/skin_tables.h"

namespace ecorche {

// Lift of every node, world, 4 floats each (w = 0): along the node's posed normal, by the change of height of the muscle surfaces
// beneath it against the blended skin. `working` is working memory.
void lift_nodes(const SkinTables& tables, const PosedAnatomy& posed, const std::vector<float>& carriers, std::vector<float>& lifts,
                std::vector<float>& working);

}  // namespace ecorche
