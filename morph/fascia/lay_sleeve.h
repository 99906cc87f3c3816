// Capsules and discs of joints: sleeves from a ring on one bone to a ring on another.
//
// Rays from a plan's rings to their middles find the bones' ends. A capsule is a taut membrane
// about them: radii that minimise the sum of squared distances of points from the mean of their
// neighbours, no smaller than the bones under it and no larger than muscle, other bone or skin over
// it let them be (an obstacle problem; see lay_fascia.h). A disc runs from the rim of one bone's
// face to that of the other and bulges between.
#pragma once

#include "anatomy/anatomy.h"
#include "anatomy/authoring/fascia_table.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {

// `tissue`: rays of all muscles and bones; `skin`: of the closed skin. Precondition: a plan of the
// form capsule or disc, all of whose bones the anatomy has.
FasciaSheet lay_sleeve(const FasciaPlan& plan, const Anatomy& anatomy, const SkinRays& tissue,
                       const SkinRays& skin);

}  // namespace ecorche::inline v1
