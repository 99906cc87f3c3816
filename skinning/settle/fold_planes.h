// Planes at which the flesh of a bent elbow or knee meets. Private to the library.
//
// Bent far, forearm and upper arm, calf and thigh are blended into each other deeper than rays of
// self-contact can part. A plane through the hinge and its axis divides the wedge between the two
// segments; what has crossed it is pushed back. It lies nearer to the segment with less flesh, so
// that both are compressed alike.
#pragma once

#include <span>
#include <vector>

#include "anatomy/skeleton.h"
#include "anatomy/types.h"
#include "skinning/binding.h"
#include "skinning/relaxed_skin.h"

namespace ecorche::inline v1 {

struct FoldParameters {
  double least_range = 2;  // rad of flexion; hinges that bend less are left to self-contact
  // Angle between the segments, rad, at which the plane begins to hold, and holds entirely.
  double begins = 1.9, holds = 1.4;
  double near_hinge = 0.03;  // m from the axis, over which it begins to hold
  // In sharp bends flesh fills the wedge next to the hinge: what lies off the plane by less than
  // `filled`, m, is drawn to it, less and less as far as `filled_along` from the axis. Angles
  // between the segments, rad, at which that begins and is done entirely.
  double filled = 0.06, filled_along = 0.2;
  double fill_begins = 1.2, fills = 0.7;
  float half_gap = 1e-3f;        // m, left on either side of the plane
  double most_of_tissue = 0.85;  // bound of a push, as a fraction of the tissue beneath
};

struct HingeFold {
  int proximal = 0, distal = 0;  // joints whose frames carry the segments; the distal one bends
  Vec3 up, down;                 // unit, from the hinge along the segments, in those frames
  double distal_share = 0.5;     // fraction of the wedge that is left to the distal segment
  std::vector<int> vertices;     // of both segments
  std::vector<float> side;       // of each: 1 distal, -1 proximal
  std::vector<float> most;       // m, bound of its push
};

// `rest`, `joint_weights`, `tissue` (between skin and bone, m): #V.
std::vector<HingeFold> make_fold_planes(const Skeleton& skeleton, std::span<const Vec3> rest,
                                        std::span<const JointWeights> joint_weights,
                                        std::span<const double> tissue);

// Pushes skin.positions off the planes and marks what has moved in `moved`, #V m. X_WJ: #joints.
void press_folds(std::span<const HingeFold> hinges, std::span<const Transform> X_WJ,
                 RelaxedSkin& skin, std::vector<float>& moved);

}  // namespace ecorche::inline v1
