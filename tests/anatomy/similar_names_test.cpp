// "Did you mean".
#include "anatomy/files/similar_names.h"

#include <gtest/gtest.h>

using namespace ecorche;

namespace {

const std::vector<std::string> kNames{"waist_girth", "waist_depth", "hip_girth", "knee_l",
                                      "knee_r",      "animate",     "fit"};

TEST(SimilarNames, SlipsOfAFingerAreFound) {
  for (const auto& [typed, meant] : {std::pair{"waist_grith", "waist_girth"},
                                     {"Waist_Girth", "waist_girth"},
                                     {"kne_l", "knee_l"},
                                     {"anmiate", "animate"},
                                     {"ft", "fit"},
                                     {"waistgirth", "waist_girth"}}) {
    const auto found = similar_names(typed, kNames);
    ASSERT_FALSE(found.empty()) << typed;
    EXPECT_EQ(found[0], meant) << typed;
  }
}

TEST(SimilarNames, WhatIsFarFromAllIsNot) {
  for (const char* typed : {"", "elephant", "xyzzy"})
    EXPECT_TRUE(similar_names(typed, kNames).empty()) << typed;
  EXPECT_TRUE(similar_names(std::string(5000, 'a'), kNames).empty());
  EXPECT_EQ(did_you_mean("elephant", kNames), "");
}

TEST(SimilarNames, PartsAndSeveral) {
  EXPECT_EQ(did_you_mean("knee", kNames), "; did you mean knee_l or knee_r?");
  EXPECT_EQ(similar_names("girth", kNames).size(), 2u);
  EXPECT_EQ(similar_names("waist_girth", kNames)[0], "waist_girth");
}

}  // namespace
