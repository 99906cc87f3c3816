// ecorche: a thin command line. Data goes to stdout, everything else to stderr.
//
// Exit codes: 0 done; 1 our bug; 2 usage; 3 input; 4 unfit input; 5 a limit of size, memory or
// threads; 6 output; 8 written, but an accuracy target was missed.
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <system_error>
#include <thread>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/cli/command_line.h"
#include "app/cli/interrupt.h"
#include "app/verbs/animate_verb.h"
#include "app/verbs/bake_verb.h"
#include "app/verbs/bench_verb.h"
#include "app/verbs/body_verb.h"
#include "app/verbs/check_verb.h"
#include "app/verbs/demo_verb.h"
#include "app/verbs/export_verb.h"
#include "app/verbs/fit_verb.h"
#include "app/verbs/forces/dynamics_verb.h"
#include "app/verbs/forces/inertia_verb.h"
#include "app/verbs/lift/lie_verb.h"
#include "app/verbs/lift/lift_verb.h"
#include "app/verbs/lift/sit_verb.h"
#include "app/verbs/list_verb.h"
#include "app/verbs/motion/fall_verb.h"
#include "app/verbs/motion/retarget_verb.h"
#include "app/verbs/posebook_verb.h"
#include "app/verbs/render_verb.h"
#include "app/verbs/shell_verbs.h"
#include "app/verbs/studio/studio_verb.h"
#include "app/verbs/template/template_verb.h"
#include "app/verbs/verb.h"
#include "app/verbs/view_verb.h"
#include "app/verbs/weights_verb.h"

namespace {

using namespace ecorche;

// Printed text may still wait in a buffer.
void finish_stdout() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(), "standard output");
}

int run(VerbFunction& chosen, Common& common) {
  common.assets = open_assets();
  const int cores = std::max(1u, std::thread::hardware_concurrency());
  const int threads = common.threads == 0 ? cores : std::min(common.threads, 4 * cores);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  std::size_t(threads));

  Report report;
  report.set("ecorche", ECORCHE_VERSION);
  report.set("threads", threads);
  if (!common.report_file.empty()) check_output(common.report_file);
  const int exit_code = chosen(common, report);
  finish_stdout();
  report.set("exit_code", exit_code);
  if (!common.report_file.empty()) report.write(common.report_file);
  if (common.verbose) note(common, report.to_text());
  return exit_code;
}

int exit_code_of(const Error& error) {
  if (dynamic_cast<const UsageError*>(&error)) return 2;
  if (dynamic_cast<const InputError*>(&error)) return 3;
  if (dynamic_cast<const UnfitError*>(&error)) return 4;
  if (dynamic_cast<const LimitError*>(&error)) return 5;
  if (dynamic_cast<const OutputError*>(&error)) return 6;
  return 1;
}

int fail(int exit_code, const std::string& message) {
  std::fprintf(stderr, "ecorche: %s\n", message.c_str());
  return exit_code;
}

// Threads that cannot be had, and a stdout that takes no more.
int fail_system(const std::system_error& e) {
  const int error = e.code().value();
  if (error == EPIPE) return 6;  // whoever read has read enough
  if (error == EAGAIN) return fail(5, "no more threads or processes to be had; try --threads 1");
  if (error == ENOSPC || error == EIO || error == EBADF)
    return fail(6, fmt::format("standard output: could not be written: {}", e.code().message()));
  return fail(1,
              fmt::format("internal error: {}; please report it with the command line", e.what()));
}

int run_words(CLI::App& app, Common& common, VerbFunction& chosen, std::vector<std::string> words) {
  if (const std::optional<std::string> unknown = unknown_word(app, words)) return fail(2, *unknown);
  try {
    std::vector<std::string> reversed(words.rbegin(), words.rend());
    app.parse(reversed);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) return fail(2, describe_parse_error(app, words, e));
    app.exit(e);
    finish_stdout();
    return 0;
  }
  return run(chosen, common);
}

void add_verbs(VerbRegistry& registry) {
  add_demo_verb(registry);
  add_template_verb(registry);
  add_body_verb(registry);
  add_fit_verb(registry);
  add_check_verb(registry);
  add_animate_verb(registry);
  add_export_verb(registry);
  add_inertia_verb(registry);
  add_dynamics_verb(registry);
  add_weights_verb(registry);
  add_bake_verb(registry);
  add_retarget_verb(registry);
  add_posebook_verb(registry);
  add_render_verb(registry);
  add_studio_verb(registry);
  add_fall_verb(registry);
  add_lift_verb(registry);
  add_lie_verb(registry);
  add_sit_verb(registry);
#ifdef ECORCHE_WINDOW
  add_view_verb(registry);
#endif
  add_bench_verb(registry);
  add_list_verb(registry);
  add_shell_verbs(registry);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a failed write, not a death
  std::signal(SIGXFSZ, SIG_IGN);  // so is a limit on the size of files
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
    return fail(1,
                "this build needs a processor with AVX2 and FMA; configure with -DECORCHE_ARCH= to "
                "build for yours");

  try {
    const InterruptWatch watch;
    CLI::App app{
        "Puts a complete set of bones and muscles into a human skin, and moves the skin by that "
        "anatomy.",
        "ecorche"};
    app.footer(
        "Start with:\n  ecorche demo -o out/long-jump\nEvery verb has --help with an example; "
        "`ecorche list` names muscles, joints, measures and more.");
    app.set_version_flag("--version,-V", ECORCHE_VERSION);
    app.require_subcommand(1);
    Common common;
    VerbFunction chosen;
    VerbRegistry registry{app, common, chosen};
    add_verbs(registry);
    return run_words(app, common, chosen, read_command_line(argc, argv));
  } catch (const Error& e) {
    return fail(exit_code_of(e), e.what());
  } catch (const std::bad_alloc&) {
    return fail(5, "out of memory; try a smaller input or fewer threads");
  } catch (const std::system_error& e) {
    return fail_system(e);
  } catch (const std::exception& e) {
    return fail(
        1, fmt::format("internal error: {}; please report it with the command line", e.what()));
  }
}
