// The posed body brought onto the scan's surface: smooth displacements towards nearest points, both
// ways, ever less stiff.
//
// Each round minimises  sum a_i w_i (n_i . (x_i - y_i))^2 + sum over scan points alike + sum l^4
// |Laplacian of the displacement|^2 a, l the length that displacements are smooth over. Vertices
// that nothing of the scan is near follow their neighbours.
#pragma once

#include <vector>

#include "morph/registration/articulated_body.h"
#include "morph/registration/point_tree.h"

namespace ecorche::inline v1 {

struct SurfaceFitInput {
  const ArticulatedBody& body;
  const SurfacePoints& scan;          // m, dense
  const std::vector<float>& area;     // #scan, m^2
  const std::vector<char>& border;    // #scan, 1: not to be matched with; may be empty
  const std::vector<char>& covering;  // #scan, 1: the body lies within; may be empty
  double spacing = 0.005;             // m, between points of what was measured
};

struct SurfaceFit {
  Points posed;            // #skin x 3
  std::vector<char> seen;  // #skin
};

// `start`: the articulated body, posed, #skin x 3.
SurfaceFit fit_surface(const SurfaceFitInput& input, const Points& start);

// Values known at some vertices continued over the skin, as smooth as can be: minimises sum
// weight (value - given)^2 + length^4 |Laplacian|^2 over the surface. #skin x 3
Points smooth_over_skin(const ArticulatedBody& body, const Points& surface, const Points& given,
                        const std::vector<double>& weight, double length);

}  // namespace ecorche::inline v1
