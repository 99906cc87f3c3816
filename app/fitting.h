// Bones and muscles into a body, dilated to its skin, with the figures of the fit in the report. Shared by fit, bench and demo.
#pragma once

#include <string>
#include <vector>

#include "anatomy/body_package.h"
#include "app/actor.h"
#include "app/report.h"
#include "morph/dilate.h"
#include "morph/fat.h"
#include "morph/fit.h"

namespace ecorche {

struct FittingOptions {
  FitOptions fit;
  DilateOptions dilate;
  bool dilated = true;  // false: muscles as they are before they grow to the skin
  bool fine_skin = false;  // the character gets the refined skin of 120,404 vertices instead of the base mesh
};

// How well the muscles fill the skin.
struct FillReport {
  int points = 0;                 // of all muscle surfaces
  int points_outside = 0;         // outside the skin, mouth and eyes closed off
  double furthest = 0;            // m
  int superficial_slices = 0;      // belly sections of superficial limb muscles
  double superficial_gap_median = 0;  // from their nearest approach to the fat layer, m
  double skin_gap_median = 0;      // from the fat layer to the muscle under it, all over the limbs, grooves and tendons included, m
};

struct FittedCharacter {
  Actor actor;                    // bound
  Anatomy undilated;              // the muscles before they grew
  FitReport fit;
  DilateReport dilation;
  FillReport fill;
  TissueMesh tissue;              // see Fit::tissue
};

FittedCharacter fit_character(const Template& body_template, const Body& body, const BodyPackage& package, const FittingOptions& options,
                              Report& report);

// Names of the accuracy targets that a fit misses, with the figures; empty when it meets them all. Exit code 8 rests on it.
std::vector<std::string> missed_targets(const FittedCharacter& fitted);

}  // namespace ecorche
