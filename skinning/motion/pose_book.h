// Named poses in anatomical angles, from a table that people read and write (data/poses/poses.csv,
// docs/posebook.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/files/csv_table.h"
#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

struct NamedPose {
  std::string name;   // "elbow_bent"
  std::string label;  // for people
  // direction of the best view: "front", "left", ... or AZIMUTH,ELEVATION in degrees
  std::string view;
  Pose pose;  // its root where it is at rest
};

// A CSV table with the columns name, label, view, angles. `angles`: parts with their angles in
// degrees, separated by semicolons:
//   JOINT FLEXION [ABDUCTION [ROTATION]]     as data/joints.csv counts them; "-" leaves an angle as
//                                            at rest. Without a side: both.
//   arm[_l|_r] ELEVATION PLANE [ROTATION]    upper arm against the thorax: 0 hanging, 180 up; plane
//                                            0 to the side, 90 forwards; rotation outwards. The
//                                            shoulder girdle follows (shoulder_rhythm.h).
//   trunk, neck FLEXION [BENDING [TURNING]]  spread over their joints in proportion to the ranges
//   of
//                                            motion; bending and turning to the left.
//   fingers[_l|_r] MCP PIP DIP               flexion of the four fingers.
// Other joints stay as at rest. Throws InputError that names the line: unknown parts, no numbers, a
// repeated name.
std::vector<NamedPose> read_pose_book(const std::filesystem::path& file, const Skeleton& skeleton);
std::vector<NamedPose> pose_book(const Table& table, const std::string& name,
                                 const Skeleton& skeleton);

// One pose from the text of `angles`; `where` stands before messages.
Pose pose_of_angles(const std::string& angles, const Skeleton& skeleton, const std::string& where);

}  // namespace ecorche::inline v1
