// How far a joint goes about each of its axes, as arcs that its bone sweeps, and drags of their
// ends.
#pragma once

#include <optional>
#include <vector>

#include "app/studio/handles/handles.h"

namespace ecorche {

// For a joint as it is turned now. Its limits are those of `seen` where they were edited.
struct LimitArc {
  int axis = 0;  // flexion, abduction, rotation
  Vec3 middle = Vec3::Zero(), now = Vec3::Zero();
  std::vector<Vec3> points{};  // from the lower limit to the upper
};
std::vector<LimitArc> limit_arcs(const Skeleton& skeleton, const Document& seen, int joint,
                                 const PosedAnatomy& posed, std::vector<Handle>& handles);

// Whole degrees. One end never passes the other.
std::optional<Action> action_of_limit(const DragInput& input, const Handle& handle,
                                      const Vec3& moved, bool one_side);

}  // namespace ecorche
