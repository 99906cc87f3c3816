// Values of options: numbers that are finite and in range, lengths with units, names out of a list.
#pragma once

#include <string>
#include <vector>

#include "anatomy/files/quantity.h"

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace ecorche {

// A finite number from `low` to `high`, both included. NaN and infinity are refused, which
// CLI::Range lets pass.
CLI::Validator between(double low, double high);

// One of the names; the message about another one suggests the most similar names.
CLI::Validator one_of(std::vector<std::string> names);

// --name LENGTH with a unit (anatomy/files/quantity.h). `metres` is set; `usual` as in
// parse_length.
CLI::Option* add_length(CLI::App& verb, const std::string& name, double& metres,
                        const LengthRange& possible, const LengthRange& usual,
                        const std::string& help);

// --name MASS in kilograms or with a unit.
CLI::Option* add_mass(CLI::App& verb, const std::string& name, double& kilograms, double low,
                      double high, const std::string& help);

}  // namespace ecorche
