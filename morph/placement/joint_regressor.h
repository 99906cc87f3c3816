// Joint centres of any skin in the base mesh's vertex order, from a few of its vertices each.
//
// A centre is a fixed affine combination of a ring of skin vertices (weights sum to 1), so that it
// moves, turns and scales with the skin, and needs nothing but the skin.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/types.h"
#include "morph/placement/half_skeleton.h"

namespace ecorche::inline v1 {

struct CentreRegressor {
  struct Row {
    std::string name;             // as in HalfSkeleton::points, left side and middle
    std::vector<int> vertices;    // of the skin
    std::vector<double> weights;  // sum 1
  };
  std::vector<Row> rows;
};

// One example: a skin and the centres that belong to it.
struct CentreExample {
  Points skin;  // #skin x 3
  NamedPoints centres;
};

// Weights that give the first example's centres exactly, the others' as nearly as the smallest
// weights allow. `mirror`: index of each vertex on the other side; centres of the middle get
// symmetric weights.
CentreRegressor learn_centres(const std::vector<CentreExample>& examples,
                              const std::vector<int>& mirror);

// Centres of the left side and the middle.
NamedPoints joint_centres(const CentreRegressor& regressor, const Points& skin);

}  // namespace ecorche::inline v1
