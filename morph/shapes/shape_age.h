// People of an age: the space of adults carried to children, the young and the old.
//
// The mean goes the way of the body package's average body, which is a child's or an old person's
// in proportions, and is then brought to the stature, mass and head that people of that age have
// (data/body/growth.csv: growth charts, the survey, a health survey of the old). What sets single
// people apart from the mean is in proportion to stature, in kilograms to mass. One way from 1 year
// to 90 without a step; without an age the space is that of the survey's adults.
#pragma once

#include <filesystem>
#include <optional>

#include "anatomy/files/assets.h"
#include "morph/shapes/shape_space.h"

namespace ecorche::inline v1 {

// The mean age of the survey's people, years.
inline constexpr double kSurveyAge = 30;
// Grown: stature no longer changes, years.
inline constexpr double kGrownAge = 18;

// What people of an age have on average, m and kg. Neck and crotch are known of children alone.
struct Growth {
  double stature = 0, mass = 0, head_girth = 0;
  std::optional<double> neck_girth{}, crotch_height{};
};

// From data/body/growth.csv, in proportion between its rows. Throws InputError.
// `tables`: Assets::tables.
Growth growth_at(const std::filesystem::path& tables, Sex sex, double years);

// The space of people of that age (1 to 90 years) instead of the survey's adults: mean, basis and
// law. `space` is one of build_shape_space. Throws InputError for a damaged table, UnfitError for
// an age outside.
void move_to_age(const BodyPackage& package, const TapeMeasure& tape, double years,
                 ShapeSpace& space);

}  // namespace ecorche::inline v1
