// A muscle's drawn surface beside that of a reference which has the same points: what stands out of
// the one that does not in the other.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/muscles/surface_edges.h"

namespace ecorche::inline v1 {

// A muscle drawn by itself, at rest.
struct DrawnMuscle {
  MuscleSurface surface;
  Points positions;

  explicit DrawnMuscle(const Muscle& muscle);
};

// Whether two muscles have the same strips and slices: then their surfaces have the same points.
bool same_sections(const Muscle& a, const Muscle& b);

class SurfaceReference {
 public:
  explicit SurfaceReference(const Muscle& reference);

  bool matches(const DrawnMuscle& muscle) const;

  // By how much each point stands farther off than in the reference made as large: less is 0. A
  // muscle that is larger as a whole is no less whole. Precondition: matches(muscle).
  Standing standing_beyond(const DrawnMuscle& muscle) const;

 private:
  DrawnMuscle drawn_;
  std::vector<SurfaceEdge> edges_;
  Standing standing_;
  double area_ = 0;  // m^2
};

}  // namespace ecorche::inline v1
