// The file of the skeleton that a motion file needs, where it lies beside the motion.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ecorche::inline v1 {

// What skeletons of a format are called.
struct SkeletonNames {
  std::string what;                  // for messages: "a skeleton (.asf)"
  std::string before;                // in front of the name: "", "character_"
  std::vector<std::string> endings;  // lower case: ".asf"
};

// In the motion's folder: the file with the motion's name, or with its name up to an underscore,
// the longest first (02 for 02_01), else the only one of these names. Throws InputError with what
// was looked for.
std::filesystem::path skeleton_beside(const std::filesystem::path& motion,
                                      const SkeletonNames& names);

}  // namespace ecorche::inline v1
