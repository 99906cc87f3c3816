#include "app/common_options.h"

#include <fmt/format.h>

#include <cstdio>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"

namespace ecorche {

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
