// Example bodies drawn from the body package, and its local shapes, as columns of displacements.
// Used to build a shape space.
#pragma once

#include <filesystem>

#include "morph/shapes/body.h"

namespace ecorche::inline v1 {

// Sliders of the i-th example of a sex, i >= 0.
Macros example_macros(Sex sex, int i);

// Skins of one sex, centred on x = 0 and standing on y = 0: 3 #skin x `count`, column by column the
// skin's rows in order. The same count gives the same examples.
Eigen::MatrixXd shape_examples(const BodyPackage& package, Sex sex, int count);

// Displacements of one usual deviation of each local shape of data/body/local_shapes.csv,
// symmetric: 3 #skin x #shapes. Throws InputError when the package lacks one.
Eigen::MatrixXd local_shapes(const BodyPackage& package, Sex sex,
                             const std::filesystem::path& folder);

// Makes each column equal on both sides.
void make_symmetric(const BodyPackage& package, Eigen::MatrixXd& columns);

}  // namespace ecorche::inline v1
