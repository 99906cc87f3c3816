// The axes of a joint in the figure, and what a drag of an end of one of them is.
#pragma once

#include <optional>
#include <vector>

#include "app/studio/handles/handles.h"

namespace ecorche {

// Adds an end of each axis of a joint. `shown_of`: the document that the skeleton was fitted for;
// the axes stand as `seen` has them.
void add_axes(const Skeleton& skeleton, const Document& shown_of, const Document& seen, int joint,
              const PosedAnatomy& posed, std::vector<Handle>& handles);

// All axes turn with the end that is dragged; rounded to 0.1 deg.
std::optional<Action> action_of_axis(const DragInput& input, const Handle& handle,
                                     const Vec3& moved, bool one_side);

}  // namespace ecorche
