#include "anatomy/authoring/muscle_groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"

namespace ecorche::inline v1 {
namespace {

std::string with_underscores(std::string_view text) {
  std::string out(text);
  std::ranges::replace(out, ' ', '_');
  return out;
}

}  // namespace

MuscleGroups read_muscle_groups(const std::filesystem::path& tables) {
  const Table table(tables / "muscle_groups.csv");
  MuscleGroups out;
  for (int row = 0; row < table.rows(); ++row) {
    MuscleGroupEntry entry{table.text(row, "nerve"), {}, table.text(row, "source")};
    std::istringstream functions(table.text(row, "functions"));
    for (std::string each; std::getline(functions, each, ';');) entry.functions.push_back(each);
    const std::string muscle = table.text(row, "muscle");
    if (entry.nerve.empty() || entry.functions.empty())
      throw InputError(
          fmt::format("{}: muscle '{}' without nerve or function", table.where(row), muscle));
    if (!out.emplace(muscle, std::move(entry)).second)
      throw InputError(fmt::format("{}: muscle '{}' stands twice", table.where(row), muscle));
  }
  return out;
}

std::vector<std::string> muscles_of_group(const MuscleGroups& groups, std::string_view word) {
  const bool nerve = word.starts_with("nerve:"), function = word.starts_with("function:");
  if (!nerve && !function) return {};
  const std::string wanted = with_underscores(word.substr(word.find(':') + 1));
  if (wanted.empty()) return {};
  std::vector<std::string> out;
  for (const auto& [muscle, entry] : groups) {
    const bool meant = nerve ? with_underscores(entry.nerve).starts_with(wanted)
                             : std::ranges::any_of(entry.functions, [&](const std::string& each) {
                                 return with_underscores(each).starts_with(wanted);
                               });
    if (meant) out.push_back(muscle);
  }
  return out;
}

std::string spelled_groups(const MuscleGroups& groups, const std::string& names) {
  std::string out;
  std::istringstream words(names);
  for (std::string word; std::getline(words, word, ',');) {
    const std::vector<std::string> muscles = muscles_of_group(groups, word);
    if (!out.empty()) out += ",";
    out += muscles.empty() ? word : fmt::format("{}", fmt::join(muscles, ","));
  }
  return out;
}

std::vector<std::string> group_words(const MuscleGroups& groups) {
  std::set<std::string> out;
  for (const auto& [muscle, entry] : groups) {
    out.insert("nerve:" + with_underscores(entry.nerve));
    for (const std::string& each : entry.functions)
      out.insert("function:" + with_underscores(each));
  }
  return {out.begin(), out.end()};
}

}  // namespace ecorche::inline v1
