// A motion for all people of a crowd: the same meshes and skeletons, and one animation over them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "anatomy/skeleton.h"
#include "skinning/crowd/crowd_read.h"

namespace ecorche::inline v1 {

struct CrowdMotionOptions {
  std::string name;    // of the animation; not one that the crowd has already
  double stagger = 0;  // s by which each person begins later than the one before
};

// The crowd as one .glb in which all move: one animation, with `move`'s motion for each person,
// whose root is in the person's own frame (soles at the origin at rest). Throws OutputError,
// LimitError (4 GiB), UsageError for a name that is taken, std::invalid_argument for a motion of
// another skeleton.
void write_crowd_motion(const std::filesystem::path& file, const Crowd& crowd,
                        const CrowdMotionOptions& options,
                        const std::function<Motion(const CrowdPerson&)>& move);

}  // namespace ecorche::inline v1
