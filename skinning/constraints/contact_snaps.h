// Contacts that a leg cannot keep without a snap.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/motion_report.h"

namespace ecorche::inline v1 {

// Where contacts make knee or ankle, seen from the pelvis, go much faster than without them: over
// 1.5 times their top speed in the motion, and by more than 0.8 m/s; or over 3 times what it is
// around the contact, and by more than 2 m/s. So it is where a foot stands as no leg
// within its limits can: each frame has its solution, and they lie on different sides. `before`:
// the motion without planting, `planted`: with it, of as many frames. #contacts, frames each
std::vector<std::vector<int>> contact_snaps(const Skeleton& skeleton, const Motion& before,
                                            const Motion& planted,
                                            const std::vector<Contact>& contacts);

// The contacts without `around`, s, to either side of their snaps, of one outside of a contact
// without as much of its end; parts below 60 ms are dropped. Infinite: those with snaps are dropped
// as they are. Precondition: #snaps == #contacts.
std::vector<Contact> contacts_between_snaps(const std::vector<Contact>& contacts,
                                            const std::vector<std::vector<int>>& snaps,
                                            double around, double fps);

}  // namespace ecorche::inline v1
