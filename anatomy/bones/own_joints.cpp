#include "anatomy/bones/own_joints.h"

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"

namespace ecorche::inline v1 {
namespace {

// A row marked as paired stands for both sides; its parent is on the same side where that is
// paired, too.
std::string sided(const Table& table, const std::string& name, const char* side) {
  for (int row = 0; row < table.rows(); ++row)
    if (table.text(row, "name") == name)
      return table.text(row, "paired") == "yes" ? name + side : name;
  return name;
}

// Whether data/joints.csv has a joint, with its side.
bool is_ours(const Table& table, const std::string& name) {
  for (int row = 0; row < table.rows(); ++row)
    for (const char* side : {"_l", "_r"})
      if (sided(table, table.text(row, "name"), side) == name) return true;
  return false;
}

}  // namespace

bool is_of_digit(std::string_view name) {
  for (const char* begin : {"cmc", "mcp", "ip", "pip", "dip", "mtp", "toe_"})
    if (name.starts_with(begin)) return true;
  return false;
}

void require_own_joints(const std::filesystem::path& tables, const Skeleton& skeleton,
                        const std::string& file) {
  const Table table(tables / "joints.csv");
  for (int row = 0; row < table.rows(); ++row)
    for (const char* side : {"_l", "_r"}) {
      const std::string name = sided(table, table.text(row, "name"), side),
                        parent = sided(table, table.text(row, "parent"), side);
      const int j = find_joint(skeleton, name);
      if (j < 0)
        throw UnfitError(fmt::format(
            "{}: its skeleton has no joint '{}'; `ecorche fit` makes characters with all of ours",
            file, name));
      int above = skeleton.joints[j].parent;
      while (above >= 0 && !is_ours(table, skeleton.joints[above].name))
        above = skeleton.joints[above].parent;
      const std::string found = above < 0 ? "" : skeleton.joints[above].name;
      if (found != parent)
        throw UnfitError(
            fmt::format("{}: joint '{}' hangs on '{}'; in our skeleton it does on '{}'", file, name,
                        found, parent));
    }
}

}  // namespace ecorche::inline v1
