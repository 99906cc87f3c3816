// Nodes on the skin that keep their height over the muscles beneath. Private to the room.
#pragma once

#include <vector>

#include "anatomy/posing/pose_anatomy.h"
#include "skinning/bind/blend_tables.h"

namespace ecorche {

// Sets each node's rest height: how far its rest point lies under the smooth tube, which lifts are
// then measured from.
void level_nodes(const PosedAnatomy& rest, SkinTables& tables);

// Lift of every node, world, 4 floats each (w = 0): along the node's posed normal, by the change of
// height of the muscle surface beneath it against the blended skin. Muscles glide along their line
// underneath; the slice that has come to lie beneath the node counts, so only the section's size
// and place lift. `working` is working memory.
void lift_nodes(const SkinTables& tables, const PosedAnatomy& posed,
                const std::vector<float>& carriers, std::vector<float>& lifts,
                std::vector<float>& working);

}  // namespace ecorche
