#include "skinning/motion/pose_table.h"

#include <utility>

#include "anatomy/files/csv_table.h"

namespace ecorche::inline v1 {

std::vector<NamedPose> read_pose_table(const std::filesystem::path& file,
                                       const Skeleton& skeleton) {
  const Table table(file);
  if (table.has_column("angles") || !table.has_column("pose") || !table.has_column("joint"))
    return read_pose_book(file, skeleton);
  std::vector<NamedPose> out;
  for (LimitPose& pose : read_limit_poses(file, skeleton, UnknownJoints::refuse))
    out.push_back({pose.name, pose.name, "oblique", std::move(pose.pose)});
  return out;
}

std::vector<LimitPose> read_check_poses(const std::filesystem::path& file,
                                        const Skeleton& skeleton) {
  if (!Table(file).has_column("angles"))
    return read_limit_poses(file, skeleton, UnknownJoints::refuse);
  std::vector<LimitPose> out;
  for (NamedPose& pose : read_pose_book(file, skeleton))
    out.push_back({std::move(pose.name), std::move(pose.pose)});
  return out;
}

}  // namespace ecorche::inline v1
