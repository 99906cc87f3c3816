// Body -> fitted anatomy: the template's bones and muscles placed inside any skin in the base mesh's topology.
//
// Joint centres come from the skin by a sparse linear regressor; each group of bones is carried by the difference between the
// body's centres and the template's, and corrected so that palpable points lie as deep as in the template, joints stay
// together and nothing pierces the skin; muscles are carried by the bones that they ride on, as they were before they grew to the
// template's skin (dilate_muscles makes them grow to the new one). All of it is a difference to the template: the template fitted
// into its own body is the template.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "morph/template.h"

namespace ecorche {

struct LandmarkDepth {
  std::string name;       // data/palpable.csv
  double depth = 0;       // of the bone below the skin, m
  double low = 0, high = 0;  // tissue expected there, m: of data/palpable.csv, for this sex, fatness and stature
};

// How far beyond a bracket a point may lie and still count as met, m.
inline constexpr double kDepthSlack = 4e-3;

struct FitReport {
  double bones_ms = 0, muscles_ms = 0;
  double stature = 0;            // m
  double asymmetry = 0;          // largest distance of a skin vertex from its partner's mirror image, m
  std::optional<double> even_about;  // x of the plane, if the skin was taken as even and one side's bones as the other's mirror images
  int iterations = 0;            // of the bones' placement
  int bone_vertices = 0;         // of the whole skeleton
  int bones_outside = 0;         // bone vertices outside the skin, mouth and eyes closed off
  double bones_furthest = 0;     // m
  std::vector<LandmarkDepth> landmarks;  // left side and middle
};

struct Fit {
  Anatomy anatomy;  // muscles carried, not yet grown to the skin
  FitReport report;
};

// Throws UnfitError for a skin that has not the base mesh's vertices, is not finite, or is far from any human shape.
// Precondition: `body_template` comes from read_template or build_template.
Fit fit_anatomy(const Template& body_template, const Body& body);

}  // namespace ecorche
