// What every verb of the command line shares. One file a verb; each adds its subcommand and the
// function that runs it.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "app/report.h"

namespace ecorche {

struct Common {
  std::filesystem::path report_file;  // --report; empty: none
  int threads = 0;                    // --threads; 0: all cores
  std::uint64_t seed = 1;             // --seed; same seed, same bytes
  bool quiet = false;                 // -q
  bool verbose = false;               // -v: the report's figures as text as well
  std::string progress = "auto";      // --progress: auto, lines, never
};

// What a verb hands back. `exit_code` 0, or 8 when an accuracy target was missed although the
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

void add_template_verb(VerbRegistry& registry);
void add_template_import(VerbRegistry& registry, CLI::App& template_verb);
void add_template_resample(VerbRegistry& registry, CLI::App& template_verb);
void add_template_sweep(VerbRegistry& registry, CLI::App& template_verb);
void add_body_verb(VerbRegistry& registry);
void add_body_measure(VerbRegistry& registry, CLI::App& body_verb);
void add_body_modify(VerbRegistry& registry, CLI::App& body_verb);
void add_body_population(VerbRegistry& registry, CLI::App& body_verb);
void add_body_size(VerbRegistry& registry, CLI::App& body_verb);
void add_check_verb(VerbRegistry& registry);
void add_fit_verb(VerbRegistry& registry);
void add_animate_verb(VerbRegistry& registry);
void add_posebook_verb(VerbRegistry& registry);
void add_render_verb(VerbRegistry& registry);
void add_view_verb(VerbRegistry& registry);
void add_weights_verb(VerbRegistry& registry);
void add_bake_verb(VerbRegistry& registry);
void add_bench_verb(VerbRegistry& registry);
void add_export_verb(VerbRegistry& registry);
void add_demo_verb(VerbRegistry& registry);
void add_list_verb(VerbRegistry& registry);
void add_shell_verbs(VerbRegistry& registry);

// Before a long computation: throws OutputError for outputs that could not be written, are inputs,
// or have one name, --report among them.
void check_outputs(const Common& common, std::vector<std::filesystem::path> outputs,
                   const std::vector<std::filesystem::path>& inputs = {});

// Throws UsageError, which names the endings, for an output with another one.
void require_ending(const std::filesystem::path& output,
                    std::initializer_list<const char*> endings);

// Notes for people go to stderr; data goes to stdout.
void note(const Common& common, const std::string& text);

}  // namespace ecorche
