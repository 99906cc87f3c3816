// The most probable body that has exactly the asked measures, or the nearest one that can be and why the asked one cannot.
//
// Unknowns are the coefficients z ~ N(0, 1) of a shape space; the body is the least |z| with c(z) = m, found by Gauss-Newton on
// linearised measures: z <- J^T (J J^T)^-1 (m - c(z) + J z), the iterated Kalman update (Bell and Cathey 1993). Region functions are
// among the coefficients, so the last millimetres need no second step. Requests further out than people are (squared Mahalanobis
// distance over a limit) are refused; the irreducible set of contradicting measures is found by deletion (Chinneck and Dravnieks
// 1991). Any number of measures, from none to all.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "morph/shape_space.h"

namespace ecorche {

struct Wish {
  int measure = 0;   // number in the tape's table
  double value = 0;  // m; kg for the mass
};

// Why a request cannot be met.
struct Conflict {
  std::vector<int> wishes;       // numbers of the wishes that contradict each other; one alone lies outside what people are
  int blamed = -1;               // the one of them that fits the others least
  double low = 0, high = 0;      // what it may be, the others kept
};

struct SolveOptions {
  double tolerance = 0.0002;     // m; a hundredfold in kg for the mass
  int rounds = 15;
};

struct SolvedBody {
  Points points;                 // #skin x 3, soles on y = 0
  Eigen::VectorXd z;             // its coefficients
  std::vector<double> achieved;  // of each wish, on the points
  double unlikeliness = 0;       // squared Mahalanobis distance of the wishes over its limit: above 1 is refused
  int rounds = 0;
  bool met = false;              // every wish to the tolerance
  std::vector<Conflict> conflicts;
};

// With conflicts, the body is the one within the limits that misses the wishes least, each by its ISO tolerance.
// `start`: coefficients of a body that is being edited; the result does not depend on them but for rounding.
// Throws UsageError when a measure is asked for twice.
SolvedBody solve_measures(const TapeMeasure& tape, const ShapeSpace& space, std::span<const Wish> wishes, const SolveOptions& options = {},
                          const Eigen::VectorXd* start = nullptr);

// The squared Mahalanobis distance that `count` measures of a person may have.
double distance_limit(int count);

// "waist_girth 0.550 m contradicts hip_girth ...: between 0.61 m and 1.02 m fits the others".
std::string describe(const Conflict& conflict, const TapeMeasure& tape, std::span<const Wish> wishes);

}  // namespace ecorche
