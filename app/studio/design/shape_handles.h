// Handles of a muscle's shape, and the actions that drags of them are: width, thickness and roll of
// sections, the ends of the flesh, and the wraps that lines slide over.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "app/studio/design/design_session.h"
#include "app/studio/handles/handles.h"

namespace ecorche {

// At every section of the table between the ends of a line: width (it rolls, too) and thickness,
// and where the flesh begins and ends. `muscle`: as the table has this side.
void add_section_handles(const TableMuscle& muscle, const DesignSession::SeenMuscle& seen,
                         std::vector<Handle>& out);
// Middles, radii and half lengths of the wraps that its lines slide over.
void add_wrap_handles(const Muscle& muscle, std::span<const Vec3> joint_rest,
                      const PosedAnatomy& posed, std::vector<Handle>& out);

// Of a handle made by the functions above; nothing for what is too small to be meant. A wrap is
// one for both sides and all who slide over it, unless the line has a radius of its own.
std::optional<Action> action_of_shape(const DragInput& input, const Handle& handle,
                                      const Vec3& moved, bool one_side);

}  // namespace ecorche
