// Muscles by nerve and function: each of the table has its row, and a word means what begins so.
#include "anatomy/authoring/muscle_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "anatomy/authoring/muscle_table.h"
#include "anatomy/errors.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

TEST(MuscleGroups, EachMuscleOfTheTableHasOneNerveAndAFunctionWithASource) {
  const MuscleGroups groups = read_muscle_groups(test_assets().tables);
  std::set<std::string> muscles;
  for (const TableMuscle& muscle : read_muscle_table(test_assets().tables).muscles)
    muscles.insert(muscle.name);
  for (const std::string& muscle : muscles) EXPECT_TRUE(groups.contains(muscle)) << muscle;
  for (const auto& [muscle, entry] : groups) {
    EXPECT_TRUE(muscles.contains(muscle)) << muscle;
    EXPECT_FALSE(entry.source.empty()) << muscle;
  }
}

TEST(MuscleGroups, AWordMeansAllThatBeginsSo) {
  const MuscleGroups groups = read_muscle_groups(test_assets().tables);
  const auto has = [&](const char* word, const char* muscle) {
    return std::ranges::count(muscles_of_group(groups, word), muscle) == 1;
  };
  EXPECT_TRUE(has("nerve:musculocutaneous_nerve", "brachialis"));
  EXPECT_TRUE(has("nerve:musculocutaneous", "brachialis"));
  EXPECT_FALSE(has("nerve:radial", "brachialis"));
  EXPECT_TRUE(has("function:elbow", "brachialis"));
  EXPECT_TRUE(has("function:elbow", "anconeus"));
  EXPECT_FALSE(has("function:elbow flexion", "anconeus"));
  for (const char* none : {"elbow", "nerve:", "nerve:xyz", "region:thigh", ""})
    EXPECT_TRUE(muscles_of_group(groups, none).empty()) << none;
  for (const std::string& word : group_words(groups))
    EXPECT_FALSE(muscles_of_group(groups, word).empty()) << word;
  EXPECT_EQ(spelled_groups(groups, "skin,nerve:thoracodorsal,soleus"),
            "skin,latissimus_dorsi_iliac,latissimus_dorsi_lumbar,latissimus_dorsi_thoracic,soleus");
}

TEST(MuscleGroups, ARowTwiceOrWithoutAFunctionIsRefused) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "groups";
  std::filesystem::create_directories(folder);
  for (const char* rows : {"a,n,f,s\na,n,f,s\n", "a,n,,s\n", "a,,f,s\n"}) {
    std::ofstream(folder / "muscle_groups.csv") << "muscle,nerve,functions,source\n" << rows;
    EXPECT_THROW(read_muscle_groups(folder), InputError) << rows;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace ecorche
