// One person changed by attributes, everything that is theirs alone kept: fat, hip to waist, single
// measures, muscle, age, exaggeration.
//
// What people of other fat or girths look like is the regression of bodies on the attribute (Seo
// and Magnenat-Thalmann 2004, section 6); in a shape space x = mean + basis z, z ~ N(0, 1), that is
// the least change of z that brings the attribute, and it is added to the person's own skin, so
// that what sets them apart from the regression stays.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "morph/shapes/solve_measures.h"

namespace ecorche::inline v1 {

// Share of the mass that is fat, per cent, from girths and height: 86.010 log10(abdomen - neck)
// - 70.041 log10(height) + 36.76 for men, 163.205 log10(abdomen + hip - neck) - 97.684
// log10(height) - 78.387 for women, lengths in inches (Hodgdon and Beckett 1984, as the examples
// paper has them). Adds the derivative to `gradient` when given.
double fat_percentage(const TapeMeasure& tape, Sex sex, const Points& skin,
                      MeasureGradient* gradient = nullptr);

// Hip girth over waist girth.
double hip_waist_ratio(const TapeMeasure& tape, const Points& skin,
                       MeasureGradient* gradient = nullptr);

struct BodyChange {
  std::optional<double> fat;        // per cent, of fat_percentage
  std::optional<double> hip_waist;  // of hip_waist_ratio
  std::vector<MeasureTarget> measures;
  std::vector<Aim> also;  // anything else to be met with them
  // stature, crotch height and arm length stay where they are not asked for (but for who grows)
  bool keep_lengths = true;
  // -1 .. 1: how far towards the least or most muscular of people (muscularity.h); the mass stays
  // then
  double muscle = 0;
  // Own age and the one to be had, years: adults of the survey where left out. What sets the person
  // apart from people of the one age sets them apart from those of the other.
  std::optional<std::pair<double, double>> age;
  double exaggeration = 1;  // of what sets the person apart from the mean; below 1 towards the mean
};

struct ChangedBody {
  Points points;  // #skin x 3, soles on y = 0
  int rounds = 0;
  bool met = false;  // attributes and measures to 0.02 per cent, 0.0002, and 0.2 mm
};

// Throws UnfitError that says what is possible when the asked measures contradict each other, the
// lengths that stay, or what people measure.
void check_change(const TapeMeasure& tape, const ShapeSpace& space, const Points& skin,
                  const BodyChange& change);

// Precondition: `skin` has the space's vertices; `adults` as read_shape_space gives it. Throws
// UsageError when a measure is asked for twice.
ChangedBody change_body(const BodyPackage& package, const TapeMeasure& tape,
                        const ShapeSpace& adults, const Points& skin, const BodyChange& change);

}  // namespace ecorche::inline v1
