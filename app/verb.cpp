#include "app/verb.h"

#include <fmt/format.h>

#include <cstdio>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
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

void check_outputs(const Common& common, std::vector<std::filesystem::path> outputs,
                   const std::vector<std::filesystem::path>& inputs) {
  outputs.push_back(common.report_file);
  check_outputs(outputs, inputs);
}

void require_ending(const std::filesystem::path& output,
                    std::initializer_list<const char*> endings) {
  std::string all;
  for (const char* ending : endings) {
    if (output.extension() == ending) return;
    all += fmt::format("{}{}{}", all.empty() ? "" : " or ", output.stem().string(), ending);
  }
  throw UsageError(fmt::format("{}: what this writes cannot end in '{}'; name it {}",
                               output.string(), output.extension().string(), all));
}

void note(const Common& common, const std::string& text) {
  if (!common.quiet) std::fprintf(stderr, "%s\n", text.c_str());
}

}  // namespace ecorche
