// The certificate of a fit: does every bone vertex and every point of a muscle's surface lie inside
// the skin?
//
// Judged with exact predicates (CGAL, side of a closed triangle mesh), independently of the
// distances that fitting works with.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

struct Containment {
  int bone_points = 0, bone_points_outside = 0;
  int muscle_points = 0, muscle_points_outside = 0;
  std::vector<int> bones;    // vertices outside, #bones
  std::vector<int> muscles;  // points outside, #muscles
};

// `closed_skin`: closed, mouth and eye cavities capped (capped_skin); vertices without triangles
// are fine. Muscles are judged at `around` points of each slice's outline. Throws
// std::invalid_argument for a skin that is not closed.
Containment check_containment(const Anatomy& anatomy, const TriMesh& closed_skin, int around = 16);

}  // namespace ecorche::inline v1
