// The pose-dependent maps that skin vertices blend. Private to the room.
#pragma once

#include <span>
#include <vector>

#include "skinning/skin_tables.h"

namespace ecorche {

int carrier_count(const SkinTables& tables);

// Maps of all carriers relative to the root: from rest minus tables.origins[0] to posed minus the root's posed origin, so that floats
// stay exact far from the world's origin. out: 16 floats a carrier, four columns of four.
// `frames` and `turns` are working memory. Precondition: X_WJ has #joints entries.
void pose_carriers(const SkinTables& tables, std::span<const Transform> X_WJ, std::vector<Transform>& frames, std::vector<Quat>& turns,
                   std::vector<float>& out);

}  // namespace ecorche
