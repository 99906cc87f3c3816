// Another program's musculoskeletal model as an anatomy of ours in the default body: a template
// that fits into any other body.
//
// Muscle paths are taken from the model's bodies to the bone package's skeleton (which stands
// upright as most models do) or to the default body's own, whichever the posture of the model
// agrees with better, and from there they go with our bones into the default body. Paths that would
// run through a wrap object at rest get via points on it; a torus becomes a via point in its hole.
//
// Volume: F0 / stress * optimal fibre length. Belly: fibres (seen along the line) and half of the
// tendon slack, which in pennate muscles is aponeurosis; a fifth of the rest is origin tendon.
// Tendons have the section that carries F0 at 30 MPa. These shares are estimates: models do not
// state them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "anatomy/files/assets.h"
#include "morph/template/match_model.h"
#include "morph/template/template.h"

namespace ecorche::inline v1 {

struct ImportOptions {
  // Pa: isometric force per physiological cross-section that the model's forces were made with
  double stress = 0.6e6;
  bool mirror = false;  // add the other side of muscles that the model has on one side only
  std::filesystem::path folder;  // where the model's meshes are; empty: none are read
};

struct ImportReport {
  ModelMatch match;
  // matched with the bone package's skeleton; false: with the default body's own
  bool upright = true;
  int muscles = 0, strips = 0, points = 0, wraps = 0;
  int via_points = 0;      // added where a wrap object or a torus holds the line at rest
  int forces_unknown = 0;  // muscles without force or fibre length
  int meshes = 0, meshes_missing = 0;
  double volume = 0;  // m^3
  double attachment_median = 0,
         // of muscle ends from the surface of the nearest bone of their joint, m
      attachment_max = 0;
  std::string attachment_worst;
  std::vector<std::string> notes;
};

struct Imported {
  // our skeleton; the model's bones where it has meshes for a joint, ours elsewhere; the model's
  // muscles
  Anatomy anatomy;
  ImportReport report;
};

// Precondition: `base` is the default template. Throws UnfitError (match_model; no muscle left),
// InputError (meshes).
Imported import_model(const MusculoskeletalModel& model, const Template& base, const Assets& assets,
                      const ImportOptions& options = {});

}  // namespace ecorche::inline v1
