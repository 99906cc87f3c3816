// The table of joint capsules and discs, data/capsules.csv, and their sleeves on the source
// skeleton.
//
// A sleeve is found from the bones alone: its middle is where two of them face each other most
// closely, its axis runs from the one to the other, and its ends are rings about each, at the
// table's distances. In each body it is laid on the bones there (morph/fascia/lay_sleeve.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/authoring/fascia_table.h"

namespace ecorche::inline v1 {

struct CapsuleRule {
  std::string name, label, group, source;  // name without side suffix
  bool paired = false;
  bool disc = false;
  // bones without side: the first of `near` carries the first ring, the last of `far` the last one
  std::vector<std::string> near, far;
  Vec3 axis = Vec3::Zero();  // from near to far; zero: as the bones face
  std::optional<Vec3> at;  // where about the faces are, source frame; none: where they are nearest
  double up = 0, down = 0, radius = 0, thickness = 0;  // m: of the rings from the middle; ...
  std::string where;
};

// `tables`: Assets::tables. Throws InputError "capsules.csv:12: knee_capsule: ..." for a table that
// is missing or not what its head says.
std::vector<CapsuleRule> read_capsule_rules(const std::filesystem::path& tables);
// `name` stands for the file in messages.
std::vector<CapsuleRule> read_capsule_text(std::string_view text, const std::string& name);

// One plan an unpaired rule, left and right of a paired one; right plans are the mirror images of
// left ones. Throws InputError for a bone that the skeleton lacks, or that has nothing where its
// ring should be.
std::vector<FasciaPlan> place_capsules(const std::vector<CapsuleRule>& rules,
                                       const Anatomy& source);

}  // namespace ecorche::inline v1
