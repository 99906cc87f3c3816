#include "app/verb.h"

#include <unistd.h>

#include <cstdio>

namespace ecorche {

CLI::App* add_verb(VerbRegistry& registry, CLI::App& parent, const std::string& name, const std::string& summary, const std::string& example,
                   VerbFunction run) {
  CLI::App* verb = parent.add_subcommand(name, summary);
  verb->footer("Example:\n  " + example);
  Common& common = registry.common;
  verb->add_option("--report", common.report_file, "Write timings, counts and quality figures to this JSON file");
  verb->add_option("--threads", common.threads, "Threads to use; 0 for all cores. The result does not depend on it")
      ->check(CLI::Range(0, 1024));
  verb->add_option("--seed", common.seed, "Seed of everything random");
  verb->add_flag("-q,--quiet", common.quiet, "Say nothing but errors");
  verb->add_flag("-v,--verbose", common.verbose, "Say more");
  verb->callback([&registry, run = std::move(run)] { registry.chosen = run; });
  return verb;
}

void note(const Common& common, const std::string& text) {
  if (!common.quiet) std::fprintf(stderr, "%s\n", text.c_str());
}

void progress(const Common& common, const std::string& what, int done, int total) {
  if (common.quiet || total <= 0 || isatty(STDERR_FILENO) == 0) return;
  constexpr int kWidth = 32;
  const int filled = static_cast<int>(static_cast<long long>(kWidth) * done / total);
  std::fprintf(stderr, "\r%-18s [%.*s%*s] %d/%d", what.c_str(), filled, "================================", kWidth - filled, "", done, total);
  if (done >= total) std::fputc('\n', stderr);
  std::fflush(stderr);
}

}  // namespace ecorche
