// Poses by name, as shares of the way to the joints' limits: what `ecorche check` measures muscles and skin in.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche {

struct LimitPose {
  std::string name;
  Pose pose;
};

// From a table like data/poses.csv, in order of first mention. Joints that the skeleton lacks are passed over, and so are poses of which nothing is
// left. Throws InputError: unreadable, malformed, a share outside [-1, 1].
std::vector<LimitPose> read_limit_poses(const std::filesystem::path& file, const Skeleton& skeleton);

// Each of `joint`'s angles moved from rest by `shares` of the way to its upper (above 0) or lower limit (below 0).
Quat limit_rotation(const Joint& joint, const Vec3& shares);

}  // namespace ecorche
