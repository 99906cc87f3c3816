// The functions of one variable that OpenSim files place joints and path points by.
#pragma once

#include <string>

#include <pugixml.hpp>

namespace ecorche::inline v1 {

// Value of the function element (Constant, LinearFunction, PolynomialFunction, MultiplierFunction,
// PiecewiseLinearFunction, PiecewiseConstantFunction, SimmSpline, NaturalCubicSpline, GCVSpline,
// Sine) at x. Splines are the cubic of Forsythe, Malcolm and Moler (1977), which is OpenSim's
// SimmSpline; other splines through the same points differ from it by little. Throws InputError for
// other elements and for tables whose x do not rise.
double osim_function(pugi::xml_node function, double x, const std::string& where);

// The function element inside a property: the element itself or its first child that is one; empty
// when there is none.
pugi::xml_node find_osim_function(pugi::xml_node property);

}  // namespace ecorche::inline v1
