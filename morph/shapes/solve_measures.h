// The most probable body that has exactly the asked measures, or the nearest one that can be and
// why the asked one cannot.
//
// Unknowns are the coefficients z ~ N(0, 1) of a shape space; the body is the least |z| with c(z) =
// m, found by Gauss-Newton on linearised measures: z <- J^T (J J^T)^-1 (m - c(z) + J z), the
// iterated Kalman update (Bell and Cathey 1993). Region functions are among the coefficients, so
// the last millimetres need no second step. Any number of measures, from none to all.
//
// A request is impossible when one of its measures lies too far from what the others let expect of
// people: the conditional residual under the law of the measures, in standard deviations, as in
// tests for outliers. The measures that already suffice to contradict it are found by deletion
// (Chinneck and Dravnieks 1991). The survey's law holds for those who are as heavy as its people or
// lighter; the heavier vary as civilians do (ShapeSpace::heavier).
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "morph/shapes/shape_space.h"

namespace ecorche::inline v1 {

struct MeasureTarget {
  int measure = 0;   // number in the tape's table
  double value = 0;  // m; kg for the mass
};

// "waist_girth=74cm" as people write it. Throws UsageError.
MeasureTarget parse_target(const std::string& text, const TapeMeasure& tape);

// Their numbers, to pick rows and columns of a law by.
std::vector<int> measures_of(std::span<const MeasureTarget> targets);

// Why a request cannot be met.
struct Conflict {
  int blamed = -1;  // number of the target that fits the others least
  std::vector<int>
      others;  // the fewest targets that contradict it; none: it lies outside what people measure
  double away = 0;           // standard deviations from what the others let expect
  double low = 0, high = 0;  // what it may be, the other targets kept
};

// Conflicts of a request, the worst first; each time the blamed target is set aside and the rest
// looked at again. Empty: none.
std::vector<Conflict> find_conflicts(const ShapeSpace& space,
                                     std::span<const MeasureTarget> targets);

// Standard deviations that one of `count` measures of a person may lie from what the others let
// expect. Alone it may lie further out: there are giants, but not with the waist of a child.
double conflict_limit(int count);

// Anything else a body is to have: its value on a skin and its derivative, appended to an empty
// one.
struct Aim {
  std::function<double(const Points&, MeasureGradient*)> value;
  double wanted = 0, tolerance = 1;
};

struct SolveOptions {
  double tolerance = 0.0002;  // m; a hundredfold in kg for the mass
  int rounds = 15;
  bool allow_unusual = false;  // do not look for conflicts: whatever the skin can be bent to
  std::vector<Aim> also;       // met with the targets, never called a conflict
};

struct SolvedBody {
  Points points;                 // #skin x 3, soles on y = 0
  Eigen::VectorXd z;             // its coefficients
  std::vector<double> achieved;  // of each target, on the points
  int rounds = 0;
  bool met = false;  // every target and aim to the tolerance
  std::vector<Conflict> conflicts;
};

// With conflicts, the body has every target but the blamed ones, which are brought to the nearest
// value that the others allow. `start`: coefficients of a body that is being edited, to be quicker;
// the result is the same to the tolerance. Throws UsageError when a measure is asked for twice,
// UnfitError when the skin has been bent out of human shape.
SolvedBody solve_measures(const TapeMeasure& tape, const ShapeSpace& space,
                          std::span<const MeasureTarget> targets, const SolveOptions& options = {},
                          const Eigen::VectorXd* start = nullptr);

// How many standard deviations a measure of a body lies from what the targets let expect, under the
// law that find_conflicts goes by.
double deviation(const ShapeSpace& space, std::span<const MeasureTarget> targets,
                 const MeasureTarget& measured);

// Throws UnfitError that names the measure when a skin is no longer a body: a girth gone to nothing
// or many times what people have.
void check_human(const TapeMeasure& tape, const ShapeSpace& space, const Points& skin);

// "waist_girth 0.550 m contradicts hip_girth 1.200 m; from 0.610 to 1.020 m is possible with the
// other measures asked".
std::string describe(const Conflict& conflict, const TapeMeasure& tape,
                     std::span<const MeasureTarget> targets);

}  // namespace ecorche::inline v1
