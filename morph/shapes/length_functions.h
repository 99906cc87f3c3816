// Smooth stretches of one part of the body, by which a height is met without a step in the skin.
//
// The skin between two levels is stretched along the vertical by a Tukey window (Tukey 1967); what
// lies above is lifted whole. The package's own length shapes act on narrow bands, which fold into
// a ridge where a short leg meets a long trunk.
#pragma once

#include <filesystem>

#include "morph/measures/measure_table.h"

namespace ecorche::inline v1 {

// The functions of data/body/lengths.csv on a skin (#skin x 3 rows of V), one usual deviation a
// column: 3 #skin x #functions. Throws InputError.
Eigen::MatrixXd length_functions(const BodyPackage& package, const MeasureTable& table,
                                 const Points& V, const std::filesystem::path& folder);

}  // namespace ecorche::inline v1
