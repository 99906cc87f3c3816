// Tables of poses of either kind, as users bring them: angles in degrees (pose_book.h) or shares
// of the way to the joints' limits (limit_poses.h).
#pragma once

#include <filesystem>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/motion/limit_poses.h"
#include "skinning/motion/pose_book.h"

namespace ecorche::inline v1 {

// By the table's columns: with `pose` and `joint` but without `angles` shares, else angles. Poses
// of shares are labelled by their names and seen obliquely. Throws InputError as read_pose_book and
// read_limit_poses do.
std::vector<NamedPose> read_pose_table(const std::filesystem::path& file, const Skeleton& skeleton);

// The same, by names alone.
std::vector<LimitPose> read_check_poses(const std::filesystem::path& file,
                                        const Skeleton& skeleton);

}  // namespace ecorche::inline v1
