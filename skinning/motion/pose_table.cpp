#include "skinning/motion/pose_table.h"

#include <string>
#include <utility>

#include "anatomy/files/csv_table.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {

std::vector<NamedPose> read_pose_table(const std::filesystem::path& file,
                                       const Skeleton& skeleton) {
  const Table table(file);
  const std::string name = printable(file.string());
  if (table.has_column("angles") || !table.has_column("pose") || !table.has_column("joint"))
    return pose_book(table, name, skeleton);
  std::vector<NamedPose> out;
  for (LimitPose& pose : limit_poses(table, name, skeleton, UnknownJoints::refuse))
    out.push_back({pose.name, pose.name, "oblique", std::move(pose.pose)});
  return out;
}

std::vector<LimitPose> read_check_poses(const std::filesystem::path& file,
                                        const Skeleton& skeleton) {
  const Table table(file);
  const std::string name = printable(file.string());
  if (!table.has_column("angles")) return limit_poses(table, name, skeleton, UnknownJoints::refuse);
  std::vector<LimitPose> out;
  for (NamedPose& pose : pose_book(table, name, skeleton))
    out.push_back({std::move(pose.name), std::move(pose.pose)});
  return out;
}

}  // namespace ecorche::inline v1
