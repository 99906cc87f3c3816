// Learning where joint centres are, and what the build says about bones, from bodies whose
// skeletons have been placed.
#pragma once

#include "morph/shapes/body.h"
#include "morph/template/template.h"

namespace ecorche::inline v1 {

// What places the bone package's skeleton in a body of average build of the body package.
PlaceInput source_input(const BodyPackage& package, const HalfSkeleton& source,
                        const FitRules& rules, const ShapedBody& body);

// Examples: the template's own body, exactly; the average woman with the source skeleton placed in
// her; short, tall and old bodies with the template's bones placed in them; and other builds, whose
// joints are those of the average build moved as the package's joint marks move with weight and
// muscle. Sets tables.regressor and tables.build; everything else that fit_input needs is set
// already.
void train(const BodyPackage& package, const HalfSkeleton& source, const ShapedBody& own,
           FitTables& tables);

}  // namespace ecorche::inline v1
