// Tells a person's sex by body measures: the quadratic discriminant of the two sexes' laws of the
// measures (shape_space.h), which are the survey's.
#pragma once

#include <array>

#include "morph/measures/tape_measure.h"
#include "morph/shapes/body.h"
#include "morph/shapes/body_model.h"

namespace ecorche::inline v1 {

// One sex's law of the tape's measures, for people of any weight.
struct MeasureLaw {
  Eigen::VectorXd mean;        // #measures, m; kg
  Eigen::MatrixXd covariance;  // #measures x #measures
};

struct SexLaws {
  TapeMeasure tape;
  std::array<MeasureLaw, 2> laws;  // male, female
};

// Throws InputError for damaged tables.
SexLaws make_sex_laws(const BodyModel& model);

// Logarithm of how many times more probable the measures of a skin are a man's than a woman's.
// Precondition: the base mesh's order, metres, standing at rest.
double male_log_odds(const SexLaws& laws, const Points& skin);

// The more probable one.
Sex told_sex(const SexLaws& laws, const Points& skin);

}  // namespace ecorche::inline v1
