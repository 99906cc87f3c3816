// Bezier curves of any degree.
#pragma once

#include <span>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct Bezier {
  std::vector<Vec3> controls;  // two or more; the first and last are the curve's ends
};

Vec3 bezier_point(const Bezier& curve, double t);
Vec3 bezier_tangent(const Bezier& curve,
                    double t);  // unit length; the chord where the derivative vanishes

// The curve of `inner` + 2 controls that starts at the first point, ends at the last and passes the
// others in order as closely as it can (least squares, a few rounds of re-parametrisation).
// Precondition: two points or more.
Bezier fit_bezier(std::span<const Vec3> points, int inner);

// Parameters that cut the curve at these fractions of its length.
std::vector<double> bezier_parameters(const Bezier& curve, std::span<const double> fractions);

double bezier_length(const Bezier& curve);

}  // namespace ecorche::inline v1
