// Broad phase of muscle contact, once a character: the anatomy is posed at the joints' limits, and
// pairs of sections that overlap there become candidates.
#pragma once

#include "anatomy/contact/contact_table.h"
#include "anatomy/posing/posing_table.h"

namespace ecorche::inline v1 {

// `posing`: made of the same anatomy. Some tenths of a second for a whole body. The same bytes at
// any number of threads.
ContactTable make_contact_table(const Anatomy& anatomy, const PosingTable& posing);

}  // namespace ecorche::inline v1
