// Whether the joints that a file names are proportioned as people's: stylised characters are not.
#pragma once

#include <string>
#include <vector>

#include "morph/registration/articulated_body.h"
#include "morph/registration/articulated_fit.h"
#include "morph/registration/scan.h"

namespace ecorche::inline v1 {

// What is more than 1.6 times as long, or less than 1 / 1.6, as in the mean person, beside the
// trunk: the head (up to the scan's highest point along the trunk), arms, legs. Words for people,
// one a part; none where joints are lacking. `hints`: of joints, m, in the scan.
std::vector<std::string> unusual_proportions(const ArticulatedBody& body, const Scan& scan,
                                             const std::vector<PlaceHint>& hints);

}  // namespace ecorche::inline v1
