#include "skinning/motion/no_such_joint.h"

#include <vector>

#include <fmt/format.h>

#include "anatomy/files/input_file.h"
#include "anatomy/files/similar_names.h"

namespace ecorche::inline v1 {

std::string no_such_joint(const Skeleton& skeleton, std::string_view name) {
  std::vector<std::string> names;
  for (const Joint& joint : skeleton.joints) names.push_back(joint.name);
  return fmt::format("'{}' is no joint of this character{}\n`ecorche list joints` names them.",
                     printable(name), did_you_mean(name, names));
}

}  // namespace ecorche::inline v1
