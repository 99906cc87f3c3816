// Broad phase of muscle contact, once a character: the anatomy is posed at the joints' limits, and
// pairs of sections that overlap there become candidates.
#pragma once

#include "anatomy/contact/contact_table.h"
#include "anatomy/posing/posing_table.h"

namespace ecorche::inline v1 {

// A body's contact on the same skeleton, with which many strips are shared.
struct ContactBefore {
  const Anatomy* anatomy = nullptr;
  const ContactTable* table = nullptr;  // null: there is none
};

// `posing`: made of the same anatomy. Some tenths of a second for a whole body. The same bytes at
// any number of threads. Strips that `before` has, too, are not compared with one another again.
ContactTable make_contact_table(const Anatomy& anatomy, const PosingTable& posing,
                                const ContactBefore& before = {});

}  // namespace ecorche::inline v1
