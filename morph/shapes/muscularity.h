// How muscular a body is among people of its stature and mass.
//
// One figure, linear in girths: what a centimetre of each says of muscle rather than fat, in
// kilograms. Arms and legs as in the anthropometric regressions of Lee et al. 2000
// (10.1093/ajcn/72.3.796) at an adult's girths, the waist as in Hodgdon and Beckett 1984, neck and
// chest smaller; weighted up where people of one stature and mass differ little. At a given mass,
// what is muscle is not fat: limbs and chest get larger, the waist smaller.
#pragma once

#include <span>

#include "morph/shapes/solve_measures.h"

namespace ecorche::inline v1 {

// The most and the least muscular that are made lie this many standard deviations from what the
// other targets let expect: one person in 160.
inline constexpr double kMostMuscular = 2.5;

// Standard deviations for a share of people, 0 .. 1: one half is what the other targets let expect.
// The ends are kMostMuscular. Throws UnfitError outside.
double muscle_deviations(double share);

// That a body is more muscular than `skin` by so many standard deviations of people with `targets`;
// girths that are wished for say nothing more. Throws UnfitError when they leave nothing to say.
Aim muscle_aim(const TapeMeasure& tape, const ShapeSpace& space,
               std::span<const MeasureTarget> targets, const Points& skin, double deviations);

}  // namespace ecorche::inline v1
