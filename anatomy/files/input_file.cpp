#include "anatomy/files/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/similar_names.h"

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;

// How many bytes the UTF-8 letter at the beginning of `text` has; 0 where there is none.
std::size_t letter_bytes(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(0);
  const std::size_t length = lead < 0x80                   ? 1
                             : lead >= 0xC2 && lead < 0xE0 ? 2
                             : lead >= 0xE0 && lead < 0xF0 ? 3
                             : lead >= 0xF0 && lead < 0xF5 ? 4
                                                           : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(k) & 0xC0) != 0x80) return 0;
  // Overlong spellings, halves of surrogate pairs, and what lies beyond the last letter.
  const bool strange =
      length > 2 && ((lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xED && byte(1) > 0x9F) ||
                     (lead == 0xF0 && byte(1) < 0x90) || (lead == 0xF4 && byte(1) > 0x8F));
  return strange ? 0 : length;
}

// "; did you mean anna.glb?": files beside a missing one whose names are nearly its own.
std::string files_like(const fs::path& missing) {
  constexpr std::size_t kMost = 10000;  // files that are looked at
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = missing.parent_path();
  for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, error), end;
       !error && entry != end && names.size() < kMost; entry.increment(error))
    names.push_back(printable(entry->path().filename().string()));
  std::sort(names.begin(), names.end());
  return did_you_mean(missing.filename().string(), names);
}

class OpenFile {
 public:
  explicit OpenFile(const fs::path& file)
      : name_(printable(file.string())),
        handle_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
    if (handle_ < 0 && errno == ENOENT)
      throw InputError(fmt::format("{}: {}{}", name_, std::generic_category().message(ENOENT),
                                   files_like(file)));
    if (handle_ < 0) fail(errno);
    struct stat info {};
    if (::fstat(handle_, &info) != 0) {
      const int reason = errno;
      ::close(handle_);
      fail(reason);
    }
    size_ = info.st_size;
    if (S_ISREG(info.st_mode) && size_ > 0) return;
    ::close(handle_);
    if (S_ISDIR(info.st_mode)) fail(EISDIR);
    if (!S_ISREG(info.st_mode))
      throw InputError(
          name_ +
          ": no regular file, but a pipe, socket or device; save what comes out of it to a file");
    throw InputError(name_ + ": empty file");
  }
  ~OpenFile() { ::close(handle_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  const std::string& name() const { return name_; }
  std::size_t size() const { return size_; }

  std::string read() const {
    std::string bytes(size_, '\0');
    for (std::size_t done = 0; done < size_;) {
      const ssize_t got = ::read(handle_, bytes.data() + done, size_ - done);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail(errno);
      if (got == 0) throw InputError(name_ + ": became shorter while it was read");
      done += got;
    }
    return bytes;
  }

 private:
  [[noreturn]] void fail(int reason) const {
    throw InputError(fmt::format("{}: {}", name_, std::generic_category().message(reason)));
  }

  std::string name_;
  int handle_ = -1;
  std::size_t size_ = 0;
};

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = letter_bytes(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = letter_bytes(text);
    if (length > 1)
      out += text.substr(0, length);
    else
      out += length == 0 || static_cast<unsigned char>(text[0]) < 0x20 || text[0] == 0x7f ? '?'
                                                                                          : text[0];
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

std::string read_input_file(const fs::path& file, std::size_t limit) {
  const OpenFile in(file);
  if (in.size() > limit)
    throw LimitError(fmt::format("{}: {} bytes; the limit is {}", in.name(), in.size(), limit));
  return in.read();
}

void check_input_file(const fs::path& file) { const OpenFile in(file); }

fs::path file_beside(const fs::path& folder, const std::string& name, const std::string& where) {
  const fs::path plain(name);
  if (name.empty() || name.find('\0') != std::string::npos || plain != plain.filename() ||
      name == "." || name == "..")
    throw InputError(fmt::format("{}: '{}' is not a file in its folder", where, printable(name)));
  const fs::path file = folder / plain;
  std::error_code error;
  const fs::path home = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  const fs::path real = error ? fs::path() : fs::canonical(file, error);
  if (error) throw InputError(fmt::format("{}: '{}': {}", where, printable(name), error.message()));
  if (real.parent_path() != home)
    throw InputError(
        fmt::format("{}: '{}' is a link that leads out of the folder", where, printable(name)));
  return file;
}

}  // namespace ecorche::inline v1
