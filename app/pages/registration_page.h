// What registration found, for people: distances by region, a page with the scan beside the body.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "app/report.h"
#include "morph/registration/registration.h"
#include "morph/registration/scan.h"

namespace ecorche {

// Distances of scan points to the registered skin, m, by the part of the body that is nearest.
struct RegionDistance {
  std::string region;  // "forearm_l"
  int points = 0;
  double mean = 0, median = 0, p95 = 0;
  double unseen = 0;  // share of the region's skin vertices that the scan does not show
};

struct RegistrationDistances {
  Points points;                 // of the scan, some 100,000, world of Registration::posed
  std::vector<double> distance;  // of each, m
  std::vector<RegionDistance> regions;
  std::vector<double> skin;  // #skin, mean distance of the scan points nearest to it, m; unseen: -1
};

RegistrationDistances registration_distances(const Scan& scan, const Registration& found,
                                             const BodyPackage& package);

// Under `register`; the names are in docs/report.md.
void report_registration(const Scan& scan, const Registration& found,
                         const RegistrationDistances& distances, double stature, Report& report);

// The skin on its way to the scan, in the scan's own axes, m: name and #skin x 3.
using RegistrationStages = std::vector<std::pair<std::string, Points>>;

// Throws OutputError if nothing can be drawn.
std::string registration_page(const std::string& title, const Scan& scan, const Registration& found,
                              const RegistrationDistances& distances,
                              const RegistrationStages& stages, const BodyPackage& package,
                              double stature);

// "+Y" for an axis of the file, "leaning" where none is within 20 degrees.
std::string axis_word(const Vec3& direction);

}  // namespace ecorche
