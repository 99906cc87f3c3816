// Bones and muscles into a body, dilated to its skin, with the figures of the fit in the report.
// Shared by fit, bench and demo.
#pragma once

#include <string>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "app/report.h"
#include "morph/dilation/dilate_muscles.h"
#include "morph/fat/fat_layer.h"
#include "morph/fat/muscle_mass.h"
#include "morph/fit/fit_anatomy.h"
#include "skinning/character/character_model.h"

namespace ecorche {

struct FittingOptions {
  FitOptions fit{};
  DilateOptions dilate{};
  bool dilated = true;  // false: muscles as they are before they grow to the skin
  // the character gets the refined skin of 120,404 vertices instead of the base mesh
  bool fine_skin = false;
  std::filesystem::path weights{};  // see ActorOptions
  bool moves = true;                // see ActorOptions
  // false: the actor has no tables and no binding, for those who want the anatomy alone
  bool bound = true;
  // false: what the body is made of and the gap under the skin are not measured; no target rests on
  // them
  bool tissues = true;
  // vertex_parts of the package, where they are at hand; read otherwise
  const std::vector<VertexPart>* parts = nullptr;
};

// How well the muscles fill the skin.
struct FillReport {
  int points = 0;                     // of all muscle surfaces
  int points_outside = 0;             // outside the skin, mouth and eyes closed off
  double furthest = 0;                // m
  int superficial_slices = 0;         // belly sections of superficial limb muscles
  double superficial_gap_median = 0;  // from their nearest approach to the fat layer, m
  // from the fat layer to the muscle under it, all over the limbs, grooves and tendons included, m
  double skin_gap_median = 0;
};

// What the body is made of, m^3. Bones are taken as solid; muscles count once where they share
// room, and not where they lie in bone.
struct Tissues {
  double body = 0;  // inside the closed skin
  double bones = 0;
  double muscles = 0;
  double layer = 0;  // fat and skin over the muscles
  double rest = 0;   // organs, vessels, deep fat, what is left
};

// Mean densities, kg/m^3: whole skeleton 1300, adipose tissue 950, organs 1050 (ICRP Publication
// 89); muscle's is in muscle_mass.h.
inline constexpr double kBoneDensity = 1300, kAdiposeDensity = 950, kOrganDensity = 1050;

struct FittedCharacter {
  Actor actor;        // bound
  Anatomy undilated;  // the muscles before they grew
  FitReport fit;
  DilateReport dilation;
  FillReport fill;
  TissueMesh tissue;  // see Fit::tissue
  Tissues tissues;
};

FittedCharacter fit_character(const Template& body_template, const Body& body,
                              const BodyPackage& package, const FittingOptions& options,
                              Report& report);

struct MissedTarget {
  std::string
      name;  // bones_outside, muscles_outside, superficial_gap, or a landmark of data/palpable.csv
  std::string what;  // with the figures
};

// The accuracy targets that a fit misses; empty when it meets them all. Exit code 8 rests on it.
std::vector<MissedTarget> missed_targets(const FittedCharacter& fitted);

}  // namespace ecorche
