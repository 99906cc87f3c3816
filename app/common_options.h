// Options that all verbs have, and functions that depend on them alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "anatomy/files/assets.h"

namespace ecorche {

struct Common {
  Assets assets;                      // opened once, by main
  std::filesystem::path report_file;  // --report; empty: none
  int threads = 0;                    // --threads; 0: all cores
  std::uint64_t seed = 1;             // --seed; same seed, same bytes
  bool quiet = false;                 // -q
  bool verbose = false;               // -v: the report's figures as text as well
  std::string progress = "auto";      // --progress: auto, lines, never
};

// Checks the outputs and --report before a long computation. Throws OutputError for an output
// that cannot be written, is an input, or has the name of another output.
void check_outputs(const Common& common, std::vector<std::filesystem::path> outputs,
                   const std::vector<std::filesystem::path>& inputs = {});

// Throws UsageError, which names `endings`, if the output has another one.
void require_ending(const std::filesystem::path& output,
                    std::initializer_list<const char*> endings);

// Prints a note to stderr unless -q was given. Data goes to stdout.
void note(const Common& common, const std::string& text);

}  // namespace ecorche
