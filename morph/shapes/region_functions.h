// Smooth displacements of one region of the skin, by which a girth is met to the millimetre without
// moving its neighbours.
//
// Each region lies around the plane of a measure. Its displacement is outwards from the region's
// axis, shaped along the axis by a rational B-spline of degree 3 (a Bezier curve where it has four
// controls), round the axis by a window, faded out by a Tukey window and smoothed into the
// neighbouring parts of the body: Kasap and Magnenat-Thalmann 2007, with the Tukey window in its
// usual form (Tukey 1967). Bust and seat push forwards and backwards by the product of two such
// curves (the try-on method).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "morph/measures/tape_measure.h"

namespace ecorche::inline v1 {

// A clamped B-spline of degree min(3, #controls - 1) with weights, at u in [0, 1]. Precondition:
// two or more controls, as many weights.
double rational_spline(std::span<const double> controls, std::span<const double> weights, double u);

// 1 in the middle of [0, 1], falling to 0 at both ends over `tapered` / 2 each as a cosine.
double tukey_window(double t, double tapered);

struct RegionFunction {
  std::string name;
  Points offsets;  // #skin x 3, one usual deviation
};

// The functions of data/body/regions.csv on a skin (#skin x 3), symmetric from left to right.
// Throws InputError.
std::vector<RegionFunction> region_functions(const BodyPackage& package, const TapeMeasure& tape,
                                             const Points& V, const std::filesystem::path& folder);

}  // namespace ecorche::inline v1
