// Every file of a corpus through a target, cut and changed a little as well.
//
//   fuzz_replay TARGET FILE_OR_FOLDER...        the files
//   fuzz_replay --changes N TARGET ...          and N changed copies of each, the same ones in
//   every run
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "tests/fuzz/targets.h"

namespace fs = std::filesystem;

namespace {

std::string changed(const std::string& bytes, std::mt19937& random) {
  std::string out = bytes;
  const auto at = [&] { return std::size_t(random() % out.size()); };
  for (unsigned k = 1 + random() % 4; k > 0 && !out.empty(); --k) switch (random() % 5) {
      case 0:
        out[at()] = char(random());
        break;
      case 1:
        out[at()] = "0123456789-+.eE\"{}[]<>,\n\r"[random() % 25];
        break;
      case 2:
        out.resize(at());
        break;
      case 3:
        out.erase(at(), random() % 9);
        break;
      default:
        out.insert(at(), out.substr(at(), random() % 40));
    }
  return out;
}

int replay(const std::string& name, const std::vector<fs::path>& files, int changes) {
  const auto& target = ecorche::test::fuzz_targets().at(name);
  int failures = 0, count = 0;
  for (const fs::path& file : files) {
    std::string bytes;
    try {
      bytes = ecorche::read_input_file(file);
    } catch (const ecorche::InputError&) {  // the empty one
    }
    std::mt19937 random(7);
    for (int k = 0; k <= changes; ++k, ++count) {
      const std::string one = k == 0 ? bytes : changed(bytes, random);
      try {
        target(one);
      } catch (const std::exception& error) {
        ++failures;
        std::fprintf(stderr, "%s: %s, change %d: %s\n", name.c_str(), file.c_str(), k,
                     error.what());
      }
    }
  }
  std::printf("%s: %d inputs, %d failures\n", name.c_str(), count, failures);
  return failures;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  int changes = 0;
  if (words.size() > 2 && words[0] == "--changes") {
    changes = std::atoi(words[1].c_str());
    words.erase(words.begin(), words.begin() + 2);
  }
  if (words.size() < 2 || !ecorche::test::fuzz_targets().contains(words[0])) {
    std::fprintf(stderr, "fuzz_replay [--changes N] TARGET FILE_OR_FOLDER...\n");
    return 2;
  }
  std::vector<fs::path> files;
  for (std::size_t k = 1; k < words.size(); ++k) {
    if (!fs::is_directory(words[k]))
      files.emplace_back(words[k]);
    else
      for (const auto& entry : fs::recursive_directory_iterator(words[k]))
        if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return replay(words[0], files, changes) == 0 ? 0 : 1;
}
