// Named poses as fractions of the ranges of motion, in which `ecorche check` measures muscles and
// skin.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/files/assets.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

struct LimitPose {
  std::string name;
  Pose pose;
};

// Treatment of a row whose joint the skeleton lacks: `refuse` for a table of the user, `pass_over`
// for our own, since imported templates may lack joints.
enum class UnknownJoints { refuse, pass_over };

// From a table like data/poses.csv, in order of first mention. `arm`, `arm_l`, `arm_r` stand for an
// upper arm against the chest with the girdle following (raise_arm.h): shares of half a turn from
// hanging, forwards and to the side, and of a quarter turn outwards. Poses without any known joint
// are left out. Throws InputError: unreadable, malformed, a share outside [-1, 1], a joint that is
// none and is to be refused, no pose at all.
std::vector<LimitPose> read_limit_poses(const std::filesystem::path& file, const Skeleton& skeleton,
                                        UnknownJoints unknown);
// `name_of_table`: its file, for messages.
std::vector<LimitPose> limit_poses(const Table& table, const std::string& name_of_table,
                                   const Skeleton& skeleton, UnknownJoints unknown);

// Those of data/poses.csv that the skeleton can take.
// `tables`: Assets::tables.
std::vector<LimitPose> standard_limit_poses(const std::filesystem::path& tables,
                                            const Skeleton& skeleton);

// Each angle of `joint` moved from rest by a fraction of the range to its upper (above 0) or lower
// limit (below 0).
Quat limit_rotation(const Joint& joint, const Vec3& shares);

}  // namespace ecorche::inline v1
