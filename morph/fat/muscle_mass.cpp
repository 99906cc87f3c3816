#include "morph/fat/muscle_mass.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ecorche::inline v1 {
namespace {

constexpr double kUnknownAgeMuscleMass = 30, kGrownMuscleMass = 18, kOldest = 90;  // years
constexpr double kObese = 30;                                                      // kg/m^2
constexpr double kBeyond = 0.125;  // of a kilogram beyond kObese

double of_adult(Sex sex, double age, double stature, double mass) {
  const double male = sex == Sex::male ? 1 : 0;
  const double within = std::min(mass, kObese * stature * stature);
  const double regression = 0.244 * within + 7.80 * stature + 6.6 * male - 0.098 * age - 3.3;
  // Beyond what was measured the line would leave the very small and old without muscle.
  constexpr double kLeastShare = 0.18;
  return std::max(regression, kLeastShare * within) + kBeyond * (mass - within);
}

struct Childhood {
  double age, stature, mass, share;  // average: m, kg, and muscle's share of the mass
};
// Stature and mass as in data/body/growth.csv; shares rounded from creatinine and magnetic
// resonance (Malina 1969, Poortmans et al. 2005; recalled, to a tenth).
constexpr std::array<Childhood, 4> kBoys{{{1, 0.757, 9.6, 0.25},
                                          {5, 1.089, 18.4, 0.34},
                                          {10, 1.386, 31.9, 0.37},
                                          {14, 1.638, 51.7, 0.41}}};
constexpr std::array<Childhood, 4> kGirls{{{1, 0.740, 8.9, 0.25},
                                           {5, 1.077, 17.9, 0.33},
                                           {10, 1.380, 32.9, 0.34},
                                           {14, 1.604, 50.1, 0.35}}};
constexpr double kBoyStature = 1.754, kBoyMass = 76.5, kGirlStature = 1.624,
                 kGirlMass = 63.8;  // at 18

double of_child(Sex sex, double age, double stature, double mass) {
  const bool male = sex == Sex::male;
  const auto& rows = male ? kBoys : kGirls;
  Childhood before = rows[0], after{kGrownMuscleMass, male ? kBoyStature : kGirlStature,
                                    male ? kBoyMass : kGirlMass, 0};
  after.share = of_adult(sex, kGrownMuscleMass, after.stature, after.mass) / after.mass;
  for (const Childhood& row : rows) {
    if (row.age <= age)
      before = row;
    else if (row.age < after.age)
      after = row;
  }
  const double t = std::clamp((age - before.age) / (after.age - before.age), 0.0, 1.0);
  const auto at = [&](double Childhood::*of) { return (1 - t) * before.*of + t * after.*of; };
  // Of children of one age, as the adults' regression has it near its middle.
  return at(&Childhood::share) * at(&Childhood::mass) *
         std::pow(mass / at(&Childhood::mass), 0.55) *
         std::pow(stature / at(&Childhood::stature), 0.45);
}

}  // namespace

double muscle_mass(Sex sex, double age, double stature, double mass) {
  const double years = std::min(age > 0 ? age : kUnknownAgeMuscleMass, kOldest);
  return years < kGrownMuscleMass ? of_child(sex, years, stature, mass)
                                  : of_adult(sex, years, stature, mass);
}

}  // namespace ecorche::inline v1
