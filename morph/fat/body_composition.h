// How much fat a person has, and where it lies.
//
// All fat by the regressions of Deurenberg, Weststrate and Seidell (1991, 10.1079/BJN19910073) on
// body mass index, age and sex; to within some 4 % of the mass, too much in the very muscular. What
// age adds to the fat of the same index lies inside: of the same share of fat the old have thinner
// skinfolds (Durnin and Womersley 1974).
#pragma once

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

inline constexpr double kAdiposeDensity = 950;  // kg/m^3 (ICRP Publication 89)

// Fat's share of a body's mass; mass from its volume where it is not known, 25 years where the age
// is not.
double estimate_fat_share(const Body& body);

// A build between those of data/fat.csv: 0 lean (athletic), 1 average, 2 obese. The larger of two:
// the one whose body mass index is the body's (21.5, 25, 34), and the one whose share of fat (11,
// 21, 33 % of men, 19, 31, 43 % of women) is what the body has, or had, at 25 years.
double estimate_fatness(const Body& body);

// m^3 of adipose tissue under the skin: what fat a body has, or had, at 25 years, but for marrow,
// viscera and muscles.
double subcutaneous_fat(const Body& body);

// m^3 of adipose tissue between and within muscles, beyond what young people of average build have:
// 5 % of their fat, and three tenths of what age adds. Whole-body magnetic resonance finds as much
// of it as visceral fat in the old (Gallagher et al. 2005, 10.1093/ajcn/81.4.903), and two to three
// times as much in thighs of the obese (Goodpaster et al. 2000, 10.1093/ajcn/71.4.885; shares
// recalled, +-50 %).
double fat_in_muscles(const Body& body);

}  // namespace ecorche::inline v1
