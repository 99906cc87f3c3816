// Muscles by nerve and by function: data/muscle_groups.csv.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ecorche::inline v1 {

struct MuscleGroupEntry {
  std::string nerve;                   // "musculocutaneous nerve"
  std::vector<std::string> functions;  // "elbow flexion", the main one first
  std::string source;
};

// By muscle, without side.
using MuscleGroups = std::map<std::string, MuscleGroupEntry, std::less<>>;

// `tables`: Assets::tables. Throws InputError as Table does, and for a muscle that stands twice or
// without nerve or function.
MuscleGroups read_muscle_groups(const std::filesystem::path& tables);

// Muscles of `nerve:NAME` or `function:NAME`, rising; blanks stand for underscores and a part of
// the name for all of it that begins so ("function:elbow" both ways). Empty for another word.
std::vector<std::string> muscles_of_group(const MuscleGroups& groups, std::string_view word);

// A list of names with commas between them, its groups spelled out.
std::string spelled_groups(const MuscleGroups& groups, const std::string& names);

// All words that muscles_of_group() takes, for messages.
std::vector<std::string> group_words(const MuscleGroups& groups);

}  // namespace ecorche::inline v1
