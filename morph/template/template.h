// The template: the skeleton and the muscles placed in the default male body, and what is needed to
// place them in any other.
#pragma once

#include <filesystem>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/body_package.h"
#include "anatomy/files/package_archive.h"
#include "morph/placement/fitted_skeleton.h"
#include "morph/placement/half_skeleton.h"
#include "morph/placement/joint_regressor.h"
#include "morph/placement/place_bones.h"

namespace ecorche {

// What fitting needs to know beside the anatomy.
struct FitTables {
  FitRules rules;
  std::vector<Muscle>
      muscles;  // the template's before they grew to its skin: what is carried into other bodies
  BodyPackage topology;  // faces, cavities, mirror of the skin; no points, no targets
  HalfSkeleton half;     // the template's own, placed
  std::vector<LandmarkTarget>
      landmarks;  // palpable points with the depth that they have in the template
  std::vector<SurfaceSample> margins;  // bone points with the distance that they keep from the skin
  std::vector<GapPair> gaps;           // between shoulder blade and ribs
  CentreRegressor regressor;
  BuildPrior build;
  double stature = 0;  // of the template's body, m
  double volume = 0;   // inside its skin, m^3
  // The built-in anatomy that the tables were made for, when the template's is another one
  // (imported); null: the template's own.
  std::shared_ptr<const Anatomy> own;
};

// Builds it from the packages and our tables; some seconds to a minute. Throws InputError for
// missing or altered inputs.
Template build_template(const Packages& packages);

// The same from the cache, building and storing it when there is none: $XDG_CACHE_HOME/ecorche,
// else ~/.cache/ecorche, else no cache. The file's name is the hash of all it was built from, so
// that it is never stale; a damaged one is built anew.
Template read_template();
Template read_template(const Packages& packages);

// How build_template places the bone package's skeleton (read_source_skeleton) in the default body;
// some seconds.
SidedPlacement place_source(const Packages& packages, const Anatomy& source, const FitRules& rules);

// Volume inside a skin, cavities closed off, m^3.
double inner_volume(const BodyPackage& topology, const Points& skin);

// What places the template's bones in another skin. The tables must outlive it.
PlaceInput fit_input(const FitTables& tables, const Points& skin, double stature);

// As bytes, for the cache. read_template_bytes throws InputError for anything but what
// write_template_bytes gave.
std::string write_template_bytes(const Template& body_template);
Template read_template_bytes(std::string_view bytes);

// Hash of everything that a template is built from: pinned packages, our tables, the version of the
// building code.
std::string template_key();

}  // namespace ecorche
