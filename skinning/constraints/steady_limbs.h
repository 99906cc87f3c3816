// Limbs that a correction would make snap move over to it in time.
//
// Limits and planting find each frame's pose by itself. Where two poses of a limb are equally good,
// a knee that bends outwards and one that bends inwards, neighbouring frames may take different
// ones. What the correction changes in the limb's angles is then averaged over time, under a raised
// cosine that is widened there until nothing goes faster than it should. Angles within a limb's
// limits have means within them; the limb's end gives way by as much as the time takes. A planted
// foot stays: the averaged leg is solved anew so that it comes back to its place, and what that
// takes fades out around the stance. The heel of a flat foot may rise by 8 deg where that slows the
// leg.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/joint_limits.h"
#include "skinning/constraints/motion_report.h"

namespace ecorche::inline v1 {

// Slows limbs whose knee or ankle, elbow or wrist, as seen from the pelvis, goes faster than 1.45
// times its top speed in `source`, or in a step faster than 3 times its speed within 0.15 s there
// and by more than 2 m/s, unless the pelvis turns as fast; other limbs are returned as they are.
// `given`: the motion before the correction, `motion`: after it, within limits; all three of as
// many frames. `contacts`: of feet that are planted in `motion`. A limb whose worst step would not
// get slower is left as it is. Returns the number of frames that were changed, each limb's counted.
int steady_limbs(const Skeleton& skeleton, const LimitTables& tables, const Motion& source,
                 const Motion& given, const std::vector<Contact>& contacts, Motion& motion);

}  // namespace ecorche::inline v1
