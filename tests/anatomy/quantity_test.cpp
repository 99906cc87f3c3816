// Lengths and masses as people write them.
#include "anatomy/files/quantity.h"

#include <gtest/gtest.h>

#include "anatomy/errors.h"

using namespace ecorche;

namespace {

constexpr LengthRange kPossible{0.5, 2.6}, kUsual{1.2, 2.3};

double height(const char* text) { return parse_length(text, "--height", kPossible, kUsual); }

std::string why(const char* text) {
  try {
    height(text);
  } catch (const UsageError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Quantity, EveryWayToWriteALengthMeansTheSame) {
  for (const char* text : {"1.778m", "1.778 m", "177.8cm", "177.8 cm", "1778mm", "17.78dm", "70in",
                           "70 inches", "70\"", "5ft10", "5ft10in", "5 ft 10 in", "5'10", "5'10\"",
                           "5' 10\"", "5.833333333ft", "5 feet 10 inches", "1.778"})
    EXPECT_NEAR(height(text), 1.778, 1e-9) << text;
  EXPECT_NEAR(height("5ft"), 1.524, 1e-12);
}

TEST(Quantity, ANumberThatCouldBeMeantOtherwiseIsRefusedWithWhatToWrite) {
  EXPECT_NE(why("178").find("178cm"), std::string::npos);
  EXPECT_NE(why("1780").find("1780mm"), std::string::npos);
  EXPECT_NE(why("70").find("70in"), std::string::npos);
  EXPECT_NE(why("5.9").find("5.9ft"), std::string::npos);
  // A waist of 1.5: metres, or feet that are usual for it.
  EXPECT_THROW(parse_length("1.5", "waist", {0.2, 2.5}, {0.4, 1.7}), UsageError);
  EXPECT_DOUBLE_EQ(parse_length("0.8", "waist", {0.2, 2.5}, {0.4, 1.7}), 0.8);
}

TEST(Quantity, WhatIsNoLengthIsRefusedByName) {
  for (const char* text :
       {"", " ", "cm", "tall", "-1.78m", "nan", "inf", "nanm", "1e400", "1.78furlongs", "1.78mm2",
        "178cmcm", "5ft13", "5ft-1", "5ft10cm", "1.78 m x", "70kg", "17m"}) {
    EXPECT_NE(why(text), "accepted") << text;
    EXPECT_NE(why(text).find("--height"), std::string::npos) << text;
  }
  EXPECT_NE(why("1,78m").find("point"), std::string::npos);
}

TEST(Quantity, Masses) {
  for (const char* text : {"70kg", "70", "70 kg", "70000g", "154.3235835lb", "154.3235835 lbs"})
    EXPECT_NEAR(parse_mass(text, "--mass", 2, 400), 70, 1e-6) << text;
  EXPECT_NEAR(parse_mass("11st4", "--mass", 2, 400), 158 * 0.45359237, 1e-9);
  EXPECT_NEAR(parse_mass("11st 4lb", "--mass", 2, 400), 158 * 0.45359237, 1e-9);
  for (const char* text : {"", "kg", "nan", "-70", "70cm", "1kg", "500", "70kgs"})
    EXPECT_THROW(parse_mass(text, "--mass", 2, 400), UsageError) << text;
}

}  // namespace
