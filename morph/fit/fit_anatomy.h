// Body -> fitted anatomy: the template's bones and muscles placed inside any skin in the base
// mesh's topology.
//
// Joint centres come from the skin by a sparse linear regressor; each group of bones is carried by
// the difference between the body's centres and the template's, and corrected so that palpable
// points lie as deep as in the template, joints stay together and nothing pierces the skin; muscles
// are carried by the bones that they ride on, or by a warp of the flesh between bones and skin, as
// they were before they grew to the template's skin (dilate_muscles makes them grow to the new
// one). All of it is a difference to the template: the template fitted into its own body is the
// template.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "morph/placement/fitted_skeleton.h"
#include "morph/placement/scale_groups.h"
#include "morph/template/template.h"
#include "morph/tissue/interior_warp.h"
#include "morph/tissue/tissue_mesh.h"

namespace ecorche::inline v1 {

struct FitOptions {
  Interior interior = Interior::bones;
  std::vector<GroupScale> scales{};  // on top of what the skin says
};

// What a warp of the soft tissue did.
struct InteriorReport {
  int nodes = 0, tetrahedra = 0;
  int inverted = 0;  // tetrahedra that the warp turned over
  double soft_before = 0,
         soft_after = 0;  // volume between bones and skin, of the template and here, m^3
  // reading (or making) the mesh and factoring its system: the template's alone
  double prepare_ms = 0;
  double warp_ms = 0;  // solving for this body
};

struct LandmarkDepth {
  std::string name;  // data/palpable.csv
  double depth = 0;  // of the bone below the skin, m
  // tissue expected there, m: of data/palpable.csv, for this sex, fatness and stature
  double low = 0, high = 0;
};

// How far beyond a bracket a point may lie and still count as met, m.
inline constexpr double kDepthSlack = 4e-3;

struct FitReport {
  double bones_ms = 0, muscles_ms = 0;
  double stature = 0;    // m
  double asymmetry = 0;  // largest distance of a skin vertex from its partner's mirror image, m
  // x of the plane, if the skin was taken as even and one side's bones as the other's mirror images
  std::optional<double> even_about;
  int iterations = 0;         // of the bones' placement
  int bone_vertices = 0;      // of the whole skeleton
  int bones_outside = 0;      // bone vertices outside the skin, mouth and eyes closed off
  double bones_furthest = 0;  // m
  std::vector<LandmarkDepth> landmarks;  // left side and middle
  InteriorReport interior;               // zeros without a warp
  double muscle_mass = 0;                // that such a person has (muscle_mass.h), kg
  double muscle_volume = 0;              // of it and the fat in it (body_composition.h), m^3
};

struct Fit {
  Anatomy anatomy;  // muscles carried, not yet grown to the skin; no fascia
  std::vector<FasciaPlan> fascia;
  FitReport report;
  TissueMesh tissue;         // carried into the body; empty without a mesh (bones, rbf)
  SidedPlacement placement;  // of the bones, which carries muscles
};

// Throws UnfitError for a skin that has not the base mesh's vertices, is not finite, or is far from
// any human shape, and as template_tissue does. Precondition: `body_template` comes from
// read_template or build_template.
Fit fit_anatomy(const Template& body_template, const Body& body, const FitOptions& options = {});

// The template's muscles in a body that was fitted before with others, as fit_anatomy has them.
// `held`: #muscles, which of before's it is; -1: it is carried. Preconditions: the same skeleton
// and skin; carried by bones alone (Interior::bones).
std::vector<Muscle> carry_muscles_again(const Template& body_template, const Body& body,
                                        const Fit& before, std::span<const int> held);

}  // namespace ecorche::inline v1
