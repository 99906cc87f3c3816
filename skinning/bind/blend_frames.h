// The pose-dependent maps that skin vertices blend. Private to the room.
#pragma once

#include <span>
#include <vector>

#include "skinning/bind/blend_tables.h"

namespace ecorche {

int carrier_count(const SkinTables& tables);

// Rotations of the joints and twist carriers as quaternions whose signs follow the chain: each
// joint turns against its parent by a swing and a twist about its long axis, both by the shorter
// arc. A raised arm may have turned more than half a circle against the chest (girdle, shoulder and
// twist add up); the way between them then is the way the joints went, not the shorter one round
// the other side, and does not jump when the sum passes half a circle.
void chain_turns(const SkinTables& tables, std::span<const Transform> X_WJ,
                 std::vector<Quat>& turns);

// Maps of all carriers relative to the root: from rest minus tables.origins[0] to posed minus the
// root's posed origin, so that floats stay exact far from the world's origin. out: 16 floats a
// carrier, four columns of four. `frames` and `turns` are working memory. Precondition: X_WJ has
// #joints entries.
void pose_carriers(const SkinTables& tables, std::span<const Transform> X_WJ,
                   std::vector<Transform>& frames, std::vector<Quat>& turns,
                   std::vector<float>& out);

}  // namespace ecorche
