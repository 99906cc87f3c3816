// How much skeletal muscle a person has.
//
// Adults: the regression of whole-body magnetic resonance on mass, stature, sex and age (Lee et al.
// 2000, 10.1093/ajcn/72.3.796, the second of their models, without its term of ethnicity; standard
// error 2.8 kg). It was fitted up to a body mass index of 30; what comes beyond is fat by more than
// there (Janssen et al. 2000, 10.1152/jappl.2000.89.1.81: curved): an eighth of it counts as
// muscle. Children: the share of the mass that growing children have, joined to the adults' at 18
// years.
#pragma once

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// kg/m^3 (Ward and Lieber 2005, 10.1016/j.jbiomech.2004.10.017).
inline constexpr double kMuscleDensity = 1056;
inline constexpr double kMuscleMassError = 2.8;  // kg, one standard error of an adult's

// kg. Ages of 0 are taken as 30 years. Preconditions: stature (m) and mass (kg) above 0.
double muscle_mass(Sex sex, double age, double stature, double mass);

}  // namespace ecorche::inline v1
