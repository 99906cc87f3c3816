// What a body's build says about its bones beyond joint centres: narrower rib cages on narrower
// shoulders, wider pelves on wider hips.
//
// Linear in the logarithms of a few distances between joint centres, which do not depend on fat or
// muscle; learned from bodies whose skeletons have been placed. Zero for the template's own body.
#pragma once

#include <vector>

#include "morph/placement/bone_solver.h"
#include "morph/placement/half_skeleton.h"

namespace ecorche::inline v1 {

struct BuildPrior {
  std::vector<double> own;        // features of the template's body
  std::vector<double> low, high;  // least and largest of the examples' features, less `own`
  Eigen::MatrixXd weights;        // #groups * way_count x #features
};

// Logarithms of stature and of distances between joint centres.
std::vector<double> build_features(const NamedPoints& centres, double stature);

struct BuildExample {
  std::vector<double> features;
  std::vector<BoneMap> placed,
      expected;  // one a group: where placing led to, and what it started from
};

// Ridge regression of the placed maps' deviations from the expected ones.
BuildPrior learn_build(const std::vector<double>& own, const FitRules& rules,
                       const std::vector<BuildExample>& examples);

// Moves a group's expected map to where bodies of such a build have it. Features beyond those of
// the examples count as the examples' last: nothing is known of such builds, and the regression
// would bend bones by centimetres.
void apply_build(const BuildPrior& prior, const std::vector<double>& features, int group,
                 BoneMap& map);

}  // namespace ecorche::inline v1
