// Bones and muscles fitted into a body and dilated to its skin, with the figures of the fit.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/body_package.h"
#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/rearrange_joints.h"
#include "morph/dilation/dilate_muscles.h"
#include "morph/fat/fat_layer.h"
#include "morph/fat/scale_fat.h"
#include "morph/fit/fit_anatomy.h"
#include "morph/fit/fit_quality.h"
#include "morph/template/template.h"
#include "morph/tissue/tissue_mesh.h"

namespace ecorche::inline v1 {

struct FittingOptions {
  FitOptions fit{};
  JointParents joints{};  // hung at last: until then the anatomy has the template's joints
  DilateOptions dilate{};
  // times as thick as the build lets expect is the fat over the muscles; the skin is not
  double layer = 1;
  SiteFactors layer_sites{};  // on top of it, around sites
  bool dilated = true;        // false: muscles as they are before they grow to the skin
  // false: what the body is made of is not measured; no target rests on it
  bool tissues = true;
  // vertex_parts of the package and template_layers, where they are at hand; made anew otherwise
  const std::vector<VertexPart>* parts = nullptr;
  const LayerOrder* layers = nullptr;
  // false: nothing is measured of how the muscles lie; the report's `fill` stays empty
  bool judged = true;
};

// How muscles grow in a body that was fitted so.
DilateOptions dilation_of(const FittingOptions& options, const FitReport& fit);

// The layer over its flesh, scaled as the options say. `wall`: of the chest's wall.
FatLayer fat_of(const Template& body_template, const Body& body, const Anatomy& anatomy,
                const SkinRays& wall, const FittingOptions& options);

struct FittedCharacter {
  Anatomy anatomy;    // of the body, in its rest pose
  Anatomy undilated;  // the muscles before they grew
  FatLayer fat;       // of the skin's vertices
  TissueMesh tissue;  // see Fit::tissue
  FittingReport report;
};

// What a fit leaves for the same body with a few other muscles (refit_character.h).
struct FitRecord {
  std::vector<Muscle> of;  // the template's, that were carried
  Fit fit;
  DilationRecord dilation;
  std::vector<Muscle> grown;
  std::vector<FasciaSheet> fascia;
};

// `body`: its skin on the base mesh. `package` must be the one that the template was built from.
// `record`: is written where it is not null. Throws as fit_anatomy does.
FittedCharacter fit_character(const Template& body_template, const Body& body,
                              const BodyPackage& package, const FittingOptions& options = {},
                              FitRecord* record = nullptr);

}  // namespace ecorche::inline v1
