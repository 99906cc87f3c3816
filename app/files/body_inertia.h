// Segment masses of characters as command lines name them.
#pragma once

#include <filesystem>

#include "anatomy/character.h"
#include "anatomy/files/assets.h"
#include "app/report.h"
#include "skinning/dynamics/segment_inertia.h"

namespace ecorche {

// Binds the character's skin and weighs its segments; figures go to the report under `inertia`.
// Throws as bind_character() and segment_inertia().
SegmentInertia weigh_character(const Assets& assets, const Character& character, Report& report);

// The same with a binding that is at hand: joint weights, a row a vertex of the skin.
SegmentInertia weigh_character(const Character& character, const Binding& binding, Report& report);

}  // namespace ecorche
