// Moves a bound skin to a pose. Per frame; allocates only when `out` changes size.
#pragma once

#include "skinning/bind/bind.h"
#include "skinning/skin_frame.h"

namespace ecorche {

// no: the skin stays where the blend and the lifts put it: some ten times faster, without kept
// volumes and contact.
enum class Settle { no, yes };

// Precondition: `posed` comes from the anatomy that was bound (same joints and slices); otherwise
// std::invalid_argument. Same input, same bytes, at any number of threads.
void deform_skin(const Binding& binding, const PosedAnatomy& posed, SkinFrame& out,
                 Settle settle = Settle::yes);

}  // namespace ecorche
