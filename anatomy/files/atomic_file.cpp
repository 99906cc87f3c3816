#include "anatomy/files/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>
#include <random>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
  throw OutputError(fmt::format("{}: could not be written: {}", file.string(), why));
}

[[noreturn]] void refuse(const fs::path& file, int error) { refuse(file, std::strerror(error)); }

// Streams do not say why they failed: the same is tried once more without one.
[[noreturn]] void fail_stream(const fs::path& file, int descriptor) {
  const std::vector<char> block(1 << 16);
  constexpr int kTries = 2;  // what there is room for may be written first
  for (int i = 0; i < kTries; ++i)
    if (::write(descriptor, block.data(), block.size()) < 0) refuse(file, errno);
  refuse(file, EIO);
}

// The files that this process is writing.
struct OpenFiles {
  std::mutex mutex;
  struct Entry {
    const AtomicFile* owner;
    fs::path file, temporary;
  };
  std::vector<Entry> open;
  std::vector<fs::path> complete;
};

OpenFiles& open_files() {
  static OpenFiles* const all = new OpenFiles;  // never destroyed: threads may still write at exit
  return *all;
}

// The place that is to hold the bytes: where a symbolic link leads, also one that leads to nothing
// yet.
fs::path follow_links(const fs::path& file) {
  constexpr int kMostLinks = 40;  // as the kernel
  fs::path place = file;
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(place, error); ++i) {
    const fs::path target = fs::read_symlink(place, error);
    if (error) break;
    place = target.is_absolute() ? target : place.parent_path() / target;
  }
  return place;
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// Parts of a temporary's name, so that those left behind are recognised.
std::string temporary_prefix(const fs::path& file) {
  return fmt::format(".{}.", file.stem().string().substr(0, 100));
}
std::string temporary_suffix(const fs::path& file) { return ".part" + file.extension().string(); }

constexpr std::size_t kRandomDigits = 16;

bool is_temporary_of(const std::string& name, const fs::path& file) {
  const std::string prefix = temporary_prefix(file), suffix = temporary_suffix(file);
  if (name.size() != prefix.size() + kRandomDigits + suffix.size()) return false;
  return name.starts_with(prefix) && name.ends_with(suffix) &&
         name.substr(prefix.size(), kRandomDigits).find_first_not_of("0123456789abcdef") ==
             std::string::npos;
}

// Removes temporaries of this file whose writers are gone: their locks are free.
void sweep_temporaries(const fs::path& file) {
  std::error_code error;
  for (fs::directory_iterator it(folder_of(file), error), end; !error && it != end;
       it.increment(error)) {
    if (!is_temporary_of(it->path().filename().string(), file)) continue;
    const int descriptor =
        ::open(it->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (descriptor < 0) continue;
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) ::unlink(it->path().c_str());
    ::close(descriptor);
  }
}

// Random, so that machines that share a folder do not meet. Same folder, so that the rename is
// atomic; same extension, so that programs that go by it still work.
fs::path temporary_for(const fs::path& file) {
  std::random_device random;
  const auto half = [&random] { return unsigned(random()); };
  return folder_of(file) / fmt::format("{}{:08x}{:08x}{}", temporary_prefix(file), half(), half(),
                                       temporary_suffix(file));
}

// Locks a new temporary. False if it was swept between its creation and its lock.
bool lock_in_place(int descriptor, const fs::path& temporary) {
  while (::flock(descriptor, LOCK_EX) != 0)  // waits for a sweep under way
    if (errno != EINTR) return true;  // where a file system knows no locks, nothing is swept either
  struct stat held, found;
  return ::fstat(descriptor, &held) == 0 && ::stat(temporary.c_str(), &found) == 0 &&
         held.st_dev == found.st_dev && held.st_ino == found.st_ino;
}

void flush_to_disk(const fs::path& written, const fs::path& file) {
  const int descriptor = ::open(written.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) refuse(file, errno);
  const int result = ::fsync(descriptor);
  const int error = errno;
  ::close(descriptor);
  if (result != 0 && error != EINVAL) refuse(file, error);
}

bool same_place(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  if (fs::equivalent(a, b, ignored)) return true;
  const fs::path wa = fs::weakly_canonical(fs::absolute(a), ignored),
                 wb = fs::weakly_canonical(fs::absolute(b), ignored);
  return !wa.empty() && wa == wb;
}

}  // namespace

AtomicFile::AtomicFile(fs::path file) : named_(std::move(file)), file_(follow_links(named_)) {
  check_output(named_);
  sweep_temporaries(file_);
  const std::lock_guard lock(
      open_files().mutex);  // which abandon_writing() keeps: nothing is begun after it
  do {
    if (lock_ >= 0) ::close(lock_);
    temporary_ = temporary_for(file_);
    lock_ = ::open(temporary_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (lock_ < 0) refuse(named_, errno);
  } while (!lock_in_place(lock_, temporary_));
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) {
    const int error = errno;
    ::unlink(temporary_.c_str());
    ::close(lock_);
    refuse(named_, error);
  }
  open_files().open.push_back({this, named_, temporary_});
}

AtomicFile::~AtomicFile() {
  stream_.close();
  if (lock_ >= 0) ::close(lock_);
  const std::lock_guard lock(open_files().mutex);
  std::erase_if(open_files().open,
                [this](const OpenFiles::Entry& entry) { return entry.owner == this; });
  if (!committed_) ::unlink(temporary_.c_str());
}

void AtomicFile::fail() const { fail_stream(named_, lock_); }

void AtomicFile::commit() {
  if (stream_.is_open()) {
    stream_.flush();
    if (!stream_) fail();
    stream_.close();
    if (!stream_) fail();
  }
  flush_to_disk(temporary_, named_);
  const std::lock_guard lock(open_files().mutex);
  if (::rename(temporary_.c_str(), file_.c_str()) != 0) refuse(named_, errno);
  committed_ = true;
  open_files().complete.push_back(named_);
}

void check_output(const fs::path& file, const std::vector<fs::path>& inputs) {
  std::error_code ignored;
  const fs::path place = follow_links(file);
  const fs::path folder = folder_of(place);
  struct stat at;
  if (file.filename().empty() || fs::is_directory(place, ignored))
    refuse(file, "Is a directory; give a file name");
  if (place.filename().string().size() > 255) refuse(file, ENAMETOOLONG);
  // Renamed over, a device or a pipe would be gone.
  if (fs::exists(place, ignored) && !fs::is_regular_file(place, ignored))
    refuse(file, "it is no regular file; give another name");
  if (::stat(folder.c_str(), &at) != 0) {
    const int error = errno;
    refuse(file, error == ENOENT
                     ? fmt::format("the folder {} does not exist; create it first", folder.string())
                     : fmt::format("the folder {}: {}", folder.string(), std::strerror(error)));
  }
  if (!S_ISDIR(at.st_mode))
    refuse(file, fmt::format("the folder {}: {}", folder.string(), std::strerror(ENOTDIR)));
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse(file, fmt::format("the folder {}: {}", folder.string(), std::strerror(errno)));
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    const fs::path whole = fs::exists(input, ignored)
                               ? input
                               : fs::path(input.string().substr(0, input.string().rfind('#')));
    if (fs::equivalent(place, whole, ignored))
      refuse(file, "it is also the input; give another name");
  }
}

void check_outputs(const std::vector<fs::path>& files, const std::vector<fs::path>& inputs) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].empty()) continue;
    check_output(files[i], inputs);
    for (std::size_t j = 0; j < i; ++j)
      if (!files[j].empty() && same_place(follow_links(files[i]), follow_links(files[j])))
        refuse(files[i], "two outputs have this name; give each its own");
  }
}

void make_output_folder(const fs::path& folder) {
  if (folder.empty()) return;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse(folder, error.message());
  if (::access(folder.c_str(), W_OK | X_OK) != 0) refuse(folder, errno);
}

void write_file_atomically(const fs::path& file, std::string_view bytes) {
  AtomicFile out(file);
  out.stream().write(bytes.data(), std::streamsize(bytes.size()));
  out.commit();
}

WrittenFiles abandon_writing() {
  open_files().mutex.lock();  // never unlocked: see commit()
  WrittenFiles out{open_files().complete, {}};
  for (const OpenFiles::Entry& entry : open_files().open) {
    ::unlink(entry.temporary.c_str());
    out.abandoned.push_back(entry.file);
  }
  return out;
}

}  // namespace ecorche::inline v1
