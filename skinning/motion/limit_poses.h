// Poses by name, as shares of the way to the joints' limits: what `ecorche check` measures muscles
// and skin in.
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

// What a row means whose joint the skeleton lacks: a slip of its writer, or, in our own table, a
// joint that an imported template does without.
enum class UnknownJoints { refuse, pass_over };

// From a table like data/poses.csv, in order of first mention. Poses of which nothing is left are
// none. Throws InputError: unreadable, malformed, a share outside [-1, 1], a joint that is none and
// is to be refused, no pose at all.
std::vector<LimitPose> read_limit_poses(const std::filesystem::path& file, const Skeleton& skeleton,
                                        UnknownJoints unknown);

// Those of data/poses.csv that the skeleton can take.
std::vector<LimitPose> standard_limit_poses(const Skeleton& skeleton);

// Each of `joint`'s angles moved from rest by `shares` of the way to its upper (above 0) or lower
// limit (below 0).
Quat limit_rotation(const Joint& joint, const Vec3& shares);

}  // namespace ecorche
