#include "skinning/retarget/joint_map_file.h"

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"

namespace ecorche::inline v1 {

std::map<std::string, std::string> read_joint_map(const std::filesystem::path& file) {
  return parse_joint_map(read_input_file(file, limits::kTableBytes), printable(file.string()));
}

std::map<std::string, std::string> parse_joint_map(std::string_view text, const std::string& name) {
  std::map<std::string, std::string> out;
  const auto trimmed = [](std::string_view words) {
    const size_t begin = words.find_first_not_of(" \t\r"), end = words.find_last_not_of(" \t\r");
    return begin == std::string_view::npos ? std::string()
                                           : std::string(words.substr(begin, end - begin + 1));
  };
  TextScan scan(text, name);
  while (scan.next_line()) {
    const std::string line = trimmed(scan.line().substr(0, scan.line().find('#')));
    if (line.empty()) continue;
    const size_t equals = line.rfind('=');
    if (equals == std::string::npos)
      scan.fail(
          fmt::format("'{}': expected 'file joint = our joint'", printable(line.substr(0, 80))));
    const std::string joint = trimmed(line.substr(0, equals));
    if (joint.empty() || out.count(joint))
      scan.fail(fmt::format("'{}': empty or given twice", printable(joint.substr(0, 80))));
    out[joint] = trimmed(line.substr(equals + 1));
  }
  if (out.empty())
    throw InputError(
        fmt::format("{}: names no joint; expected lines 'file joint = our joint'", name));
  return out;
}

}  // namespace ecorche::inline v1
