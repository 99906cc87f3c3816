// ecorche: a thin command line. Data goes to stdout, everything else to stderr; exit codes are those of anatomy/errors.h.
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <optional>
#include <thread>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "app/verb.h"

namespace {

using namespace ecorche;

int run(VerbFunction& chosen, const Common& common) {
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int threads = common.threads == 0 ? cores : std::min(common.threads, 4 * cores);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));

  Report report;
  report.set("ecorche", ECORCHE_VERSION);
  report.set("threads", threads);
  if (!common.report_file.empty()) check_output(common.report_file);
  const int exit_code = chosen(common, report);
  report.set("exit_code", exit_code);
  if (!common.report_file.empty()) report.write(common.report_file);
  return exit_code;
}

int fail(int exit_code, const char* message) {
  std::fprintf(stderr, "ecorche: %s\n", message);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a failed write, not a death
  std::signal(SIGXFSZ, SIG_IGN);  // so is a limit on the size of files
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
    return fail(1, "this build needs a processor with AVX2 and FMA; configure with -DECORCHE_ARCH= to build for yours");

  CLI::App app{"Puts a complete set of bones and muscles into any human skin, and moves the skin by that anatomy."};
  app.footer("Start with:\n  ecorche demo -o out/long-jump\nEvery verb has --help with an example.");
  app.set_version_flag("--version", ECORCHE_VERSION);
  app.require_subcommand(1);

  Common common;
  VerbFunction chosen;
  VerbRegistry registry{app, common, chosen};
  add_demo_verb(registry);
  add_template_verb(registry);
  add_body_verb(registry);
  add_fit_verb(registry);
  add_check_verb(registry);
  add_animate_verb(registry);
  add_export_verb(registry);
  add_weights_verb(registry);
  add_bake_verb(registry);
  add_posebook_verb(registry);
  add_render_verb(registry);
#ifdef ECORCHE_WINDOW
  add_view_verb(registry);
#endif
  add_bench_verb(registry);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    return run(chosen, common);
  } catch (const Error& e) {
    return fail(e.exit_code(), e.what());
  } catch (const std::bad_alloc&) {
    return fail(5, "out of memory; try a smaller input or fewer threads");
  } catch (const std::exception& e) {
    return fail(1, (std::string("internal error: ") + e.what() + "; please report it with the command line").c_str());
  }
}
