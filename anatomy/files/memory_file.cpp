#include "anatomy/files/memory_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {

MemoryFile::MemoryFile(std::string what)
    : what_(std::move(what)), descriptor_(memfd_create("ecorche", MFD_CLOEXEC)) {
  if (descriptor_ < 0) fail();
}

MemoryFile::~MemoryFile() { close(descriptor_); }

void MemoryFile::write_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail();
    bytes.remove_prefix(std::size_t(n));
  }
  lseek(descriptor_, 0, SEEK_SET);
}

std::string MemoryFile::read_all(std::size_t most) const {
  const off_t end = lseek(descriptor_, 0, SEEK_END);
  std::string out(std::min(most, std::size_t(std::max<off_t>(0, end))), '\0');
  for (std::size_t at = 0; at < out.size();) {
    const ssize_t n = pread(descriptor_, out.data() + at, out.size() - at, off_t(at));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail();
    at += std::size_t(n);
  }
  return out;
}

void MemoryFile::fail() const {
  throw LimitError(fmt::format("{}: no memory for the other program's data: {}", what_,
                               std::generic_category().message(errno)));
}

}  // namespace ecorche::inline v1
