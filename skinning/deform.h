// Moves a bound skin to a pose. Per frame; allocates only when `out` changes size.
#pragma once

#include <span>

#include "skinning/bind.h"
#include "skinning/skin_frame.h"

namespace ecorche {

// Precondition: `posed` comes from the anatomy that was bound (same joints and slices); otherwise std::invalid_argument.
// Same input, same bytes at any number of threads.
// `flesh`: how far loose flesh lags (skinning/flesh_motion.h); empty: not at all. Ignored by a binding that is not elastic.
void deform_skin(const Binding& binding, const PosedAnatomy& posed, SkinFrame& out, std::span<const float> flesh = {});

}  // namespace ecorche
