// Feature points of a standing skin, found from horizontal sections alone: armpits, bust, waist,
// hip, crotch (the try-on method).
//
// Works on any skin that stands on y = 0, faces +Z and holds its arms away from the trunk; no
// landmarks, no known topology.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct FeatureGirth {
  double height = 0;  // above the floor, m
  double girth = 0;   // of the section's convex hull, m
};

struct BodyFeatures {
  double stature = 0, crotch_height = 0;                         // m
  Vec3 armpit_left = Vec3::Zero(), armpit_right = Vec3::Zero();  // where trunk and arm part, world
  FeatureGirth bust;   // the largest between armpits and waist
  FeatureGirth waist;  // the smallest between bust and hip
  FeatureGirth hip;    // the largest between crotch and waist
};

// Sections every `step` m. Throws UnfitError that says which point could not be found (arms against
// the trunk, legs closed, not standing).
BodyFeatures find_features(const TriMesh& skin, double step = 0.002);

}  // namespace ecorche::inline v1
