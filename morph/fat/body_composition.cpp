#include "morph/fat/body_composition.h"

#include <algorithm>
#include <array>

#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {

namespace {

// Fat's share of the mass of the builds of data/fat.csv.
constexpr std::array<double, 3> kMaleBuilds{0.11, 0.21, 0.33}, kFemaleBuilds{0.19, 0.31, 0.43};
// Their body mass indices: of the first only in athletes.
constexpr std::array<double, 3> kIndexBuilds{21.5, 25, 34};
constexpr double kGrown = 16, kLeastAge = 7,
                 kMostAge = 83;  // years: where the regressions were fitted
// years. What age adds to the fat of the same index lies inside: at the same share skinfolds get
// thinner with it
constexpr double kYoung = 25;

// Shares of young people's fat (Shen et al. 2004; recalled, to a third).
constexpr double kInMarrow = 0.06, kInMuscles = 0.05, kVisceralMale = 0.12, kVisceralFemale = 0.07;
constexpr double kOfAgeInMuscles = 0.3;
constexpr double kFatInAdipose = 0.85;  // by mass (ICRP Publication 89)

double mass_of(const Body& body) {
  constexpr double kDensity = 1010;  // kg/m^3, with the air in the lungs
  return body.mass > 0 ? body.mass : kDensity * mesh_volume(body.skin);
}

double mass_index(const Body& body) {
  const double height = body.skin.V.col(1).maxCoeff() - body.skin.V.col(1).minCoeff();
  return mass_of(body) / (height * height);
}

// Where a figure lies among those of the three builds: 0, 1, 2.
double between(const std::array<double, 3>& builds, double x) {
  return x < builds[1] ? (x - builds[0]) / (builds[1] - builds[0])
                       : 1 + (x - builds[1]) / (builds[2] - builds[1]);
}

const std::array<double, 3>& builds_of(Sex sex) {
  return sex == Sex::male ? kMaleBuilds : kFemaleBuilds;
}

double fat_share(const Body& body, double age) {
  const double index = mass_index(body), male = body.sex == Sex::male;
  const double percent = age < kGrown ? 1.51 * index - 0.70 * age - 3.6 * male + 1.4
                                      : 1.20 * index + 0.23 * age - 10.8 * male - 5.4;
  return std::clamp(0.01 * percent, 0.02, 0.6);
}

double age_of(const Body& body) {
  return std::clamp(body.age > 0 ? body.age : kYoung, kLeastAge, kMostAge);
}

double share_when_young(const Body& body) {
  return fat_share(body, std::min(age_of(body), kYoung));
}

// m^3 of tissue that holds so much fat, kg.
double adipose(double fat) { return fat / (kAdiposeDensity * kFatInAdipose); }

}  // namespace

double estimate_fat_share(const Body& body) { return fat_share(body, age_of(body)); }

double estimate_fatness(const Body& body) {
  return std::clamp(std::max(between(builds_of(body.sex), share_when_young(body)),
                             between(kIndexBuilds, mass_index(body))),
                    -1.0, 3.0);
}

double subcutaneous_fat(const Body& body) {
  const double visceral = body.sex == Sex::male ? kVisceralMale : kVisceralFemale;
  return adipose((1 - kInMarrow - kInMuscles - visceral) * share_when_young(body) * mass_of(body));
}

double fat_in_muscles(const Body& body) {
  const double young = share_when_young(body), more = std::max(0.0, young - builds_of(body.sex)[1]),
               with_age = std::max(0.0, estimate_fat_share(body) - young);
  return adipose((kInMuscles * more + kOfAgeInMuscles * with_age) * mass_of(body));
}

}  // namespace ecorche::inline v1
