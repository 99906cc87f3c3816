// Interpolation of inner points from a skin that changes: bones and muscles follow a slider at
// once, before they are fitted anew.
//
// The affine map that fits the skin's change best moves the inside exactly. The remaining change is
// interpolated by moving least squares (Schaefer, McPhail and Warren 2006): each inner point is a
// fixed combination of skin points around it, with weights that fall with the fourth power of the
// distance. Where these points lie nearly in a plane, as over the back or the belly, they determine
// the inward direction badly; there the point moves without rotation (a ridge of 5 % of their
// spread), because otherwise noise in the plane moves deep points out of the body.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct SkinInterpolation {
  static constexpr int kAnchors = 48;  // skin points an inner point hangs on
  Points inside;                       // as they were
  std::vector<int> samples;            // skin vertices that count, some 20 mm apart
  Points sampled;                      // where they were
  Eigen::Matrix<double, 4, Eigen::Dynamic>
      affine;  // of the samples' new places: rows of the affine map that fits them best
  std::vector<int> anchors;    // of samples, kAnchors an inner point
  std::vector<float> weights;  // as many; those of a point sum to 1
};

// Throws std::invalid_argument for a skin of fewer than kAnchors such points.
SkinInterpolation make_skin_interpolation(const Points& skin, const Points& inside);

// Where the inner points are in the changed skin. `out` is resized once and then reused.
void carry(const SkinInterpolation& carrier, const Points& changed_skin, Points& out);

}  // namespace ecorche::inline v1
