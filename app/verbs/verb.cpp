#include "app/verbs/verb.h"

#include <CLI/CLI.hpp>

#include "app/options/option_values.h"

namespace ecorche {

CLI::App* add_verb(VerbRegistry& registry, CLI::App& parent, const std::string& name,
                   const std::string& summary, const std::string& example, VerbFunction run) {
  CLI::App* verb = parent.add_subcommand(name, summary);
  verb->footer("Example:\n  " + example);
  Common& common = registry.common;
  verb->add_option("--report", common.report_file,
                   "Write timings, counts and quality figures to this JSON file");
  verb->add_option("--threads", common.threads,
                   "Threads to use; 0 for all cores. The result does not depend on it")
      ->check(between(0, 1024));
  verb->add_option("--seed", common.seed, "Seed of everything random: a whole number")
      ->check(between(0, 18446744073709549568.0));
  verb->add_option("--progress", common.progress,
                   "How far long work is: auto (a bar on a terminal), lines (a line every few "
                   "seconds, anywhere), never")
      ->check(one_of({"auto", "lines", "never"}));
  CLI::Option* quiet = verb->add_flag("-q,--quiet", common.quiet, "Say nothing but errors");
  verb->add_flag("-v,--verbose", common.verbose,
                 "Say what was found, measured and timed: the report's figures as text")
      ->excludes(quiet);
  verb->callback([&registry, run = std::move(run)] { registry.chosen = run; });
  return verb;
}

}  // namespace ecorche
