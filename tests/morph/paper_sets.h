// The input sets of the examples paper (Seo and Magnenat-Thalmann 2004, tables 1 and 2), centimetres.
#pragma once

#include <array>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche {

inline constexpr std::array<const char*, 8> kPaperMeasures{"neck_base_girth", "chest_girth", "underbust_girth", "waist_girth",
                                                           "hip_girth",       "stature",     "crotch_height",   "arm_length_outseam"};

inline const std::vector<std::array<double, 8>>& paper_sets(Sex sex) {
  static const std::vector<std::array<double, 8>> male{
      {38, 105, 100, 93, 98, 177, 72, 59}, {42, 105, 101, 107, 109, 179, 68, 67}, {36, 87, 84, 79, 94, 184, 73, 70},    {35, 102, 95, 84, 92, 180, 76, 64},
      {44, 114, 108, 102, 101, 177, 70, 63}, {40, 102, 100, 101, 98, 179, 73, 65}, {46, 120, 117, 114, 115, 171, 66, 60}, {36, 99, 95, 88, 94, 180, 74, 67},
      {38, 103, 96, 92, 97, 174, 68, 60},  {41, 105, 101, 98, 101, 182, 75, 66},  {42, 113, 108, 106, 108, 196, 77, 66}, {35, 89, 83, 77, 92, 195, 83, 70},
      {41, 103, 99, 99, 101, 184, 73, 66}, {44, 115, 109, 98, 100, 182, 74, 67}};
  static const std::vector<std::array<double, 8>> female{
      {34, 103, 84, 89, 107, 167, 72, 56}, {34, 92, 76, 75, 112, 184, 82, 57},     {32, 87, 75, 68, 94, 170, 74, 58},    {32, 85, 71, 73, 93, 154, 66, 49},
      {33, 91, 74, 63, 93, 174, 75, 53},   {41, 124, 109, 116, 122, 177, 74, 58},  {40, 114, 103, 113, 122, 164, 70, 55}, {32, 88, 73, 63, 89, 168, 69, 53},
      {34, 98, 80, 72, 103, 175, 78, 58},  {37, 98, 89, 87, 103, 154, 67, 52},     {38, 116, 102, 104, 116, 170, 73, 54}, {33, 89, 75, 70, 99, 175, 77, 60},
      {32, 85, 74, 71, 98, 169, 71, 60},   {36, 101, 82, 87, 99, 160, 71, 50},     {37, 91, 81, 81, 98, 162, 71, 56},    {35, 102, 86, 79, 107, 173, 73, 59}};
  return sex == Sex::male ? male : female;
}

}  // namespace ecorche
