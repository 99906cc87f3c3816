// A body fitted again after a few of its muscles have changed, in a part of the time.
//
// Bones and fat stay. Muscles that have changed are carried and grown, and with them those next to
// where they were or are now; all others are held, and come out as they did before. The growing
// muscles meet them round after round as they were then (dilation_record.h), so that what comes out
// is the whole fit's, but for what a change hands on from neighbour to neighbour beyond those, and
// for the hundredths of a millimetre by which all muscles share the body's volume otherwise. Sheets
// of fascia are laid anew where a muscle near them has grown.
#pragma once

#include <optional>

#include "morph/fit/fit_character.h"

namespace ecorche::inline v1 {

// `before`: of a whole fit of the same body with the same options, skeleton, fascia and package;
// muscles are matched by name. None where that leads nowhere: another method than fit_character's
// own, or more than two fifths of the muscles to be grown. What judges a body is not measured.
std::optional<FittedCharacter> refit_character(const Template& body_template, const Body& body,
                                               const BodyPackage& package,
                                               const FittingOptions& options,
                                               const FitRecord& before);

}  // namespace ecorche::inline v1
