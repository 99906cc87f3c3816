// Whether what names call eyes, mouth or hair is in the head.
//
// Makers of characters share materials: shoes may wear the black of the eyes. Such a part is eyes
// island by island, as its place, its size and its weights bear the name out.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "anatomy/mesh_files/part_kind.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct HeadIsland {
  PartKind kind = PartKind::eyes;  // by name
  Eigen::AlignedBox3d box;
  std::optional<bool> on_head{};  // whether it hangs on joints of the head, where weights tell
};

// Kinds that are parts of a head.
inline bool is_in_head(PartKind kind) {
  return kind == PartKind::hair || kind == PartKind::eyes || kind == PartKind::mouth;
}

// 1: the name may stand; 0: it is none of its kind. Weights decide where they tell. Otherwise eyes
// and mouth are small, and lie in the upper half of a figure that is upright along `up`; of any
// other figure they lie at that end where most of them are. `figure`: the box of all that is
// neither prop nor surroundings. #islands
std::vector<char> lies_in_head(std::span<const HeadIsland> islands,
                               const Eigen::AlignedBox3d& figure, const std::optional<Vec3>& up);

}  // namespace ecorche::inline v1
