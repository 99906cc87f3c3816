// Metres in a unit of a file that need not say: the one that makes it a person of human size.
#pragma once

#include <optional>
#include <string>

namespace ecorche::inline v1 {

struct ScanUnit {
  double metres = 1;
  bool known = false;  // false: no unit gives a person; the largest extent was made 1.7 m
  std::string note;    // what was assumed, and what else it may be
};

// `extent`: the largest, `area`: of the surface or 0, both in the file's units; `said`: metres in a
// unit as the file states it. Metre, decimetre, centimetre, millimetre, inch and foot are weighed
// by how usual they are and by the size of people: adults first, then children, the bent and
// busts. Precondition: extent > 0.
ScanUnit guess_unit(double extent, double area, std::optional<double> said);

}  // namespace ecorche::inline v1
