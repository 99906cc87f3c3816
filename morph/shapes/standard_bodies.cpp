#include "morph/shapes/standard_bodies.h"

namespace ecorche::inline v1 {

std::vector<BodySpec> standard_bodies() {
  constexpr Sex male = Sex::male, female = Sex::female;
  return {
      {.sex = male, .name = "default_male"},
      {.sex = female, .name = "default_female"},
      {.sex = male, .age = 25, .height = 1.75, .mass = 56, .name = "thin_male"},
      {.sex = female, .age = 25, .height = 1.64, .mass = 46, .name = "thin_female"},
      {.sex = male, .age = 40, .height = 1.75, .mass = 110, .name = "heavy_male"},
      {.sex = female, .age = 40, .height = 1.64, .mass = 85, .name = "heavy_female"},
      {.sex = male, .age = 25, .height = 1.80, .mass = 92, .muscle = 0.95, .name = "muscular_male"},
      {.sex = female,
       .age = 25,
       .height = 1.68,
       .mass = 64,
       .muscle = 0.95,
       .name = "muscular_female"},
      {.sex = male, .age = 25, .height = 1.50, .name = "short_male"},
      {.sex = female, .age = 25, .height = 1.50, .name = "short_female"},
      {.sex = male, .age = 25, .height = 2.00, .name = "tall_male"},
      {.sex = male, .age = 80, .height = 1.70, .name = "old_male"},
      {.sex = female, .age = 80, .height = 1.57, .name = "old_female"},
      {.sex = male, .age = 14, .height = 1.60, .name = "young_male"},
      {.sex = female, .age = 14, .height = 1.55, .name = "young_female"}};
}

BodySpec athlete() {
  return {
      .sex = Sex::male, .age = 25, .height = 1.85, .mass = 78, .muscle = 0.95, .name = "athlete"};
}

}  // namespace ecorche::inline v1
