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
  std::error_code ignored;
  const fs::path folder = file_.has_parent_path() ? file_.parent_path() : fs::path(".");
  if (file_.filename().empty() || fs::is_directory(file_, ignored)) fail(file_, "it names a folder; give a file name");
  if (!fs::is_directory(folder, ignored)) fail(file_, fmt::format("the folder {} does not exist; create it first", folder.string()));
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

void write_file_atomically(const fs::path& file, std::string_view bytes) {
  AtomicFile out(file);
  out.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.commit();
}

}  // namespace ecorche
