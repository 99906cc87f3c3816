// The rules of data/joints.csv: from bones and the MJCF's joints to our joint tree.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/model_files/mjcf_meshes.h"

namespace ecorche::inline v1 {

// Model axes of the MJCF to world axes: (x, y, z) -> (x, z, -y).
Vec3 world_from_mjcf(const Vec3& v);

// `bones` holds the unpaired bones and the left ones, in the world. Grammar: head of
// data/joints.csv. Throws InputError that names the table's line: unknown body, bone, joint or
// rule; a parent that does not precede; limits that fall; a direction square to the motion it
// should tell the sense of.
Skeleton place_joints(const Table& table, const Mjcf& mjcf, const std::vector<Bone>& bones);

}  // namespace ecorche::inline v1
