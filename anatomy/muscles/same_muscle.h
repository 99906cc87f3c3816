// Whether two muscles are one and the same, to the last digit: what was worked out for one of them
// then holds for the other.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

bool is_same(const Strip& a, const Strip& b);
// Name, words, figures and strips.
bool is_same(const Muscle& a, const Muscle& b);

// Sections of muscles that two bodies both have, numbered as slice_ranges does it.
struct SharedSections {
  std::vector<int> now;     // #sections before, where each is now; -1: nowhere
  std::vector<int> before;  // #sections now, where each was; -1: nowhere
};
SharedSections shared_sections(const Anatomy& now, const Anatomy& before);

}  // namespace ecorche::inline v1
