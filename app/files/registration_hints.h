// What people tell registration where guessing fails: landmarks on the scan, the pose it stands in.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche {

// Landmarks of a JSON object: {"acromion_l": [x, y, z], ...}, in the coordinates of the scan's
// file; "landmarks" may wrap it. `known`: names and vertices that there are. Throws InputError for
// files that are not that, UnfitError for unknown names (with similar ones) and for none.
std::vector<Landmark> read_scan_landmarks(const std::filesystem::path& file,
                                          const std::vector<std::pair<std::string, int>>& known);

// Joints of the first frame of a BVH file that stands in the scan, in the scan's coordinates, by
// our skeleton's names ("elbow_l"). Throws InputError, UnfitError where fewer than six are known.
std::vector<Landmark> read_posed_joints(const std::filesystem::path& file);

}  // namespace ecorche
