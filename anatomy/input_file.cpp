#include "anatomy/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche {

std::string printable(const std::string& text) {
  std::string out = text;
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return out;
}

std::string read_input_file(const std::filesystem::path& file, std::size_t limit) {
  const std::string name = printable(file.string());
  const int handle = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (handle < 0) throw InputError(fmt::format("{}: cannot be opened: {}", name, std::strerror(errno)));
  struct Closer {
    int handle;
    ~Closer() { ::close(handle); }
  } closer{handle};
  struct stat info {};
  if (::fstat(handle, &info) != 0) throw InputError(fmt::format("{}: cannot be examined: {}", name, std::strerror(errno)));
  if (S_ISDIR(info.st_mode)) throw InputError(fmt::format("{}: is a folder; name a file in it", name));
  if (!S_ISREG(info.st_mode)) throw InputError(fmt::format("{}: is no regular file", name));
  if (info.st_size == 0) throw InputError(fmt::format("{}: empty file", name));
  if (static_cast<std::size_t>(info.st_size) > limit) {
    throw LimitError(fmt::format("{}: {} bytes; the limit is {}", name, info.st_size, limit));
  }
  std::string bytes(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(handle, bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(fmt::format("{}: cannot be read: {}", name, std::strerror(errno)));
    if (got == 0) throw InputError(fmt::format("{}: became shorter while it was read", name));
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

}  // namespace ecorche
