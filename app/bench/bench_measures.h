// Times of solving bodies from measurements, for `ecorche bench`.
#pragma once

#include <string>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/character.h"

namespace ecorche {

struct TimedLine {
  std::string name, what;
  double seconds = 0, asked = 0;  // CPU time of one thread
};

// A new body from eight measures; one measure of eight edited; the same with the character's bones
// and muscles carried along; the 24 girths, lengths and breadths of the regions paper asked and one
// of them edited, on the fine skin.
std::vector<TimedLine> bench_measures(const BodyPackage& package, const Character& character,
                                      int rounds);

}  // namespace ecorche
