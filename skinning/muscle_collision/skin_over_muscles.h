// The steps of deform_over_muscles() on the mesh that settles. Private to the room.
#pragma once

#include <span>

#include "skinning/muscle_collision/muscle_collision.h"

namespace ecorche {

// `rest`: the anatomy's rest pose, without contact or with it. `skin`: its rest skin, in the vertex
// order that frames have.
UnderSkin make_under_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin);

// Raises the skin (#V x 4), the less the less `open` (#V, 0 .. 1) it is. False where nothing comes
// out. Precondition: slices and skin are of what `under` was made of; otherwise
// std::invalid_argument. The same bytes at any number of threads.
bool rise_over_muscles(const UnderSkin& under, std::span<const Ellipse> slices,
                       std::span<const float> open, std::span<float> positions,
                       UnderSkinMemory& memory);

// After that: 0 where a muscle lies at the surface .. 1 where none is near, #V. There the skin may
// sink again.
std::span<const float> room_over_muscles(const UnderSkinMemory& memory);

// After that, and for the same memory: sections and outlines of `posed` that are still out give
// way. `normals`: of the skin as it is now, #V x 4; `pressed`: #V, not 0 where the skin has been
// pressed in since; empty where it has nowhere.
void give_way_to_skin(const UnderSkin& under, const PosingTable& table,
                      std::span<const float> positions, std::span<const float> normals,
                      std::span<const char> pressed, PosedAnatomy& posed, UnderSkinMemory& memory);

}  // namespace ecorche
