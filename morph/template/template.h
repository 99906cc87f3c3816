// The template: the skeleton and the muscles placed in the default male body, and what is needed to
// place them in any other.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/authoring/fascia_table.h"
#include "anatomy/base_mesh/body_package.h"
#include "morph/fat/fat_layer.h"
#include "morph/placement/half_skeleton.h"
#include "morph/placement/joint_regressor.h"
#include "morph/placement/place_bones.h"

namespace ecorche::inline v1 {

// What fitting needs to know beside the anatomy.
struct FitTables {
  FatTables fat;
  FitRules rules;
  std::vector<Muscle>
      muscles;  // the template's before they grew to its skin: what is carried into other bodies
  std::vector<FasciaPlan> fascia;  // in the template's body
  BodyPackage topology;            // faces, cavities, mirror of the skin; no points, no targets
  HalfSkeleton half;               // the template's own, placed
  std::vector<LandmarkTarget>
      landmarks;  // palpable points with the depth that they have in the template
  std::vector<SurfaceSample> margins;  // bone points with the distance that they keep from the skin
  std::vector<GapPair> gaps;           // between shoulder blade and ribs
  CentreRegressor regressor;
  BuildPrior build;
  double stature = 0;  // of the template's body, m
  double volume = 0;   // inside its skin, m^3
  // The built-in anatomy that the tables were made for, when the template's is another one
  // (imported).
  std::optional<Anatomy> built_in;

  explicit FitTables(FatTables fat_tables) : fat(std::move(fat_tables)) {}
};

// An anatomy and the body it was authored in.
struct Template {
  Anatomy anatomy;
  Body body;
  FitTables tables;
};

// The anatomy that the tables were made for: the built-in one.
const Anatomy& table_anatomy(const Template& body_template);

// Volume inside a skin, cavities closed off, m^3.
double inner_volume(const BodyPackage& topology, const Points& skin);

// What places the template's bones in another skin. The tables must outlive it.
PlaceInput fit_input(const FitTables& tables, const Points& skin, double stature);

}  // namespace ecorche::inline v1
