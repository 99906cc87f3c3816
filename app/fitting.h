// Bones and muscles into a body, with the figures of the fit in the report. Shared by the verbs fit, bench and demo.
#pragma once

#include "app/report.h"
#include "morph/fit.h"
#include "skinning/character_io.h"

namespace ecorche {

struct FittedCharacter {
  Character character;
  FitReport report;
};

FittedCharacter fit_character(const Template& body_template, const Body& body, const FitOptions& options, Report& report);

// Names of the accuracy targets that a fit misses, with the figures; empty when it meets them all. Exit code 8 rests on it.
std::vector<std::string> missed_targets(const FitReport& report);

}  // namespace ecorche
