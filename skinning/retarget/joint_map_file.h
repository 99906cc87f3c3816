// Joint maps that people write for motion files whose joints have foreign names.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace ecorche::inline v1 {

// Lines "file joint = our joint", '#' comments. Throws InputError with file and line, also for a
// map that names no joint.
std::map<std::string, std::string> read_joint_map(const std::filesystem::path& file);
std::map<std::string, std::string> parse_joint_map(std::string_view text, const std::string& name);

}  // namespace ecorche::inline v1
