// Volume, first and second moments of solids that triangles bound: exact integrals over signed
// tetrahedra (Mirtich 1996, 10.1080/10867651.1996.10487458; Eberly 2002).
#pragma once

#include <span>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Integrals over a solid, about the origin of its coordinates.
struct SolidMoments {
  double volume = 0;           // of 1, m^3
  Vec3 first = Vec3::Zero();   // of x, m^4
  Mat3 second = Mat3::Zero();  // of x x^T, m^5
};

// first + factor * second: of solids side by side, or inside one another.
void add_moments(const SolidMoments& part, double factor, SolidMoments& sum);

// Inertia about the solid's own centre, of density 1, m^5. Precondition: a volume above 0.
Mat3 central_inertia(const SolidMoments& solid);

// Of a closed mesh; positive with outward normals. Open rims are closed by fans from `apex`.
SolidMoments solid_moments(const TriMesh& mesh, const Vec3& apex = Vec3::Zero());

// Of the part of a closed mesh where `field` (#V, linear on triangles) is above 0. The cut is
// closed by a fan from `apex` to its rim: exactly its plane where the field is the height over a
// plane through the apex.
SolidMoments solid_moments_above(const TriMesh& mesh, std::span<const double> field,
                                 const Vec3& apex);

// Of an ellipsoid. axes: columns, unit; radii along them, m.
SolidMoments ellipsoid_moments(const Vec3& center, const Mat3& axes, const Vec3& radii);

}  // namespace ecorche::inline v1
