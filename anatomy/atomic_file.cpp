#include "anatomy/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::string& why) {
  throw OutputError(fmt::format("{}: could not be written: {}", file.string(), why));
}

// Same folder, so that the rename is atomic; same extension, so that programs that go by it still work.
fs::path temporary_for(const fs::path& file) {
  static std::atomic<int> counter{0};
  fs::path name = fmt::format(".{}.{}-{}", file.stem().string().substr(0, 100), ::getpid(), counter++);
  name += file.extension();
  return file.parent_path() / name;
}

void flush_to_disk(const fs::path& written, const fs::path& file) {
  const int descriptor = ::open(written.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(file, std::strerror(errno));
  const int result = ::fsync(descriptor);
  const int error = errno;
  ::close(descriptor);
  if (result != 0 && error != EINVAL) fail(file, std::strerror(error));
}

}  // namespace

AtomicFile::AtomicFile(fs::path file) : file_(std::move(file)), temporary_(temporary_for(file_)) {
  check_output(file_);
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) fail(file_, std::strerror(errno));
}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void AtomicFile::commit() {
  if (stream_.is_open()) {
    stream_.flush();
    if (!stream_) fail(file_, std::strerror(errno));
    stream_.close();
    if (!stream_) fail(file_, std::strerror(errno));
  }
  flush_to_disk(temporary_, file_);
  std::error_code error;
  fs::rename(temporary_, file_, error);
  if (error) fail(file_, error.message());
  committed_ = true;
}

void check_output(const fs::path& file, const std::vector<fs::path>& inputs) {
  std::error_code ignored;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (file.filename().empty() || fs::is_directory(file, ignored)) fail(file, "it names a folder; give a file name");
  // Renamed over, a device or a pipe would be gone.
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) fail(file, "it is no regular file; give another name");
  if (!fs::is_directory(folder, ignored)) fail(file, fmt::format("the folder {} does not exist; create it first", folder.string()));
  if (::access(folder.c_str(), W_OK) != 0) fail(file, fmt::format("the folder {}: {}", folder.string(), std::strerror(errno)));
  for (const fs::path& input : inputs) {
    const fs::path whole = fs::exists(input, ignored) ? input : fs::path(input.string().substr(0, input.string().rfind('#')));
    if (fs::equivalent(file, whole, ignored)) fail(file, "it is also the input; give another name");
  }
}

void write_file_atomically(const fs::path& file, std::string_view bytes) {
  AtomicFile out(file);
  out.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.commit();
}

}  // namespace ecorche
