#include "anatomy/mesh_files/scene_import.h"

#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/child_processes.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/memory_file.h"
#include "anatomy/limits.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::string_view kBinaryFbx = "Kaydara FBX Binary";
constexpr long long kOldestFbx = 7100;  // of 2011: files before it hold another kind of objects

// The child's status as waitpid gives it; nothing where its time was up, and it was ended.
std::optional<int> ended_in_time(const ChildProcess& child) {
  using namespace std::chrono;
  const auto deadline = steady_clock::now() + seconds(limits::kImportSeconds);
  for (milliseconds pause{1};; pause = std::min(2 * pause, milliseconds(20))) {
    int status = 0;
    const pid_t found = waitpid(child.pid(), &status, WNOHANG);
    if (found == child.pid()) return status;
    if (found < 0 && errno != EINTR) return 127 << 8;
    if (steady_clock::now() > deadline) {
      ::kill(-child.pid(), SIGKILL);
      while (waitpid(child.pid(), &status, 0) < 0 && errno == EINTR) continue;
      return std::nullopt;
    }
    std::this_thread::sleep_for(pause);
  }
}

std::optional<int> run_import(const std::string& format, const MemoryFile& in,
                              const MemoryFile& out, const MemoryFile& words,
                              const std::string& name) {
  // Else what PATH has.
  const std::string program =
      find_program("ECORCHE_IMPORT", "ecorche-import").value_or("ecorche-import").string();
  try {
    ChildProcess child =
        start_program({program, format}, in.descriptor(), out.descriptor(), words.descriptor());
    const std::optional<int> status = ended_in_time(child);
    child.ended();
    return status;
  } catch (const std::system_error& e) {
    throw UnfitError(
        fmt::format("{}: the program {}, which reads FBX and COLLADA, cannot be started ({}); "
                    "install it beside "
                    "ecorche, name it in ECORCHE_IMPORT, or save the file as .glb",
                    name, program, e.code().message()));
  }
}

// What the child's end means, for the file's owner.
[[noreturn]] void fail_import(int status, const std::string& words, const std::string& name) {
  const std::string kind = "reading it as FBX or COLLADA";
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGXFSZ))
    throw LimitError(
        fmt::format("{}: {} took more than {} s or gave more than {} bytes; save it as .glb", name,
                    kind, limits::kImportSeconds, limits::kImportBytes));
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
    throw LimitError(fmt::format("{}: {} was ended by the system; save it as .glb", name, kind));
  if (WIFSIGNALED(status))
    throw InputError(fmt::format("{}: malformed: {} broke off (signal {}); save it as .glb", name,
                                 kind, WTERMSIG(status)));
  const std::string why = words.empty() ? "no reason given" : words;
  switch (WEXITSTATUS(status)) {
    case 3:
      throw InputError(fmt::format("{}: {}", name, why));
    case 4:
      throw UnfitError(fmt::format("{}: {}", name, why));
    case 5:
      throw LimitError(fmt::format("{}: {}", name, why));
    case 127:
      throw UnfitError(
          fmt::format("{}: ecorche-import cannot run on this machine: {}; save the "
                      "file as .glb",
                      name, why));
    default:
      throw InputError(
          fmt::format("{}: {} failed with status {}: {}", name, kind, WEXITSTATUS(status), why));
  }
}

// The version that an FBX file states; 0: none.
long long fbx_version(std::string_view bytes) {
  if (bytes.starts_with(kBinaryFbx)) {
    std::uint32_t version = 0;
    if (bytes.size() >= 27) std::memcpy(&version, bytes.data() + 23, sizeof version);
    return version;
  }
  constexpr std::string_view kKey = "FBXVersion:";
  const std::string_view head = bytes.substr(0, 65536);
  const std::size_t at = head.find(kKey);
  if (at == std::string_view::npos) return 0;
  std::string_view digits = head.substr(at + kKey.size());
  digits.remove_prefix(std::min(digits.find_first_not_of(" \t"), digits.size()));
  long long version = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), version);
  return version;
}

void check_fbx(std::string_view bytes, const std::string& name) {
  const long long version = fbx_version(bytes);
  if (version == 0)
    throw InputError(name +
                     ": an FBX file that does not say its version, or is cut within its "
                     "header");
  if (version < kOldestFbx)
    throw UnfitError(fmt::format(
        "{}: FBX of version {}; those before {} (2011) are not read; save it as FBX 2013 or newer, "
        "binary, or as .glb",
        name, version, kOldestFbx));
}

}  // namespace

std::optional<std::string> scene_format(std::string_view bytes) {
  if (bytes.starts_with(kBinaryFbx)) return "fbx";
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return std::nullopt;
  const std::string_view head = bytes.substr(first, 65536);
  if (head.front() == '<' && head.find("<COLLADA") != std::string_view::npos) return "dae";
  if (head.starts_with("; FBX") || head.starts_with("FBXHeaderExtension:") ||
      (head.front() == ';' &&
       head.substr(0, 4096).find("\nFBXHeaderExtension:") != std::string_view::npos))
    return "fbx";
  return std::nullopt;
}

std::string import_scene(std::string_view bytes, const std::string& name) {
  const std::optional<std::string> format = scene_format(bytes);
  if (!format) throw InputError(name + ": neither FBX nor COLLADA");
  if (*format == "fbx") check_fbx(bytes, name);
  MemoryFile in(name), out(name), words(name);
  in.write_all(bytes);
  const std::optional<int> status = run_import(*format, in, out, words, name);
  if (!status)
    throw LimitError(fmt::format("{}: reading it took more than {} s; save it as .glb", name,
                                 limits::kImportSeconds));
  if (!WIFEXITED(*status) || WEXITSTATUS(*status) != 0) {
    std::string text = printable(words.read_all(400));
    while (!text.empty() && (text.back() == '?' || text.back() == ' ')) text.pop_back();
    fail_import(*status, text, name);
  }
  return out.read_all(limits::kImportBytes);
}

std::string import_scene(const std::filesystem::path& file) {
  return import_scene(read_input_file(file), printable(file.string()));
}

}  // namespace ecorche::inline v1
