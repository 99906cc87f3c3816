// A verb of the command line: its subcommand, the options that all verbs share, and the function
// that runs it.
#pragma once

#include <functional>
#include <string>

#include "app/common_options.h"
#include "app/report.h"

namespace CLI {
class App;
}

namespace ecorche {

// Runs a verb. Returns the exit code: 0, or 8 when an accuracy target was missed although the
// output was written.
using VerbFunction = std::function<int(const Common&, Report&)>;

struct VerbRegistry {
  CLI::App& app;
  Common& common;
  VerbFunction& chosen;  // set by the subcommand that was given
};

// Adds --report, --threads, --seed, --progress, -q and -v, an example to --help, and makes `run`
// the chosen function. Returns the subcommand, for the verb's own options. `parent` is the
// executable or a verb with verbs of its own.
CLI::App* add_verb(VerbRegistry& registry, CLI::App& parent, const std::string& name,
                   const std::string& summary, const std::string& example, VerbFunction run);

}  // namespace ecorche
