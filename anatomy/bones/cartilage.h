// Cartilage where the bone meshes hold it, for looks. Rules are in data/cartilage.csv.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

struct CartilageRule {
  std::string bone;
  int faces = 0;                       // of the mesh that the rule is for
  double from = 0, to = 1, aside = 0;  // see the table
};

// `tables`: Assets::tables. Throws InputError for a missing or malformed table.
std::vector<CartilageRule> read_cartilage_rules(const std::filesystem::path& tables);

// One flag a face; all false for a bone without rules.
std::vector<char> cartilage_faces(const std::vector<CartilageRule>& rules, const Bone& bone);

}  // namespace ecorche::inline v1
