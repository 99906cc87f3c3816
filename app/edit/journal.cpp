#include "app/edit/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

[[noreturn]] void fail_journal(const std::filesystem::path& file, const std::string& why) {
  throw OutputError(fmt::format("{}: {}", file.string(), why));
}

std::string text_of_journal(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(in), {});
  text.resize(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  return text;
}

}  // namespace

std::vector<std::string> read_journal(const std::filesystem::path& file) {
  const std::string text = text_of_journal(file);
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    out.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

JournalBegin begin_of_journal(const std::vector<std::string>& lines, bool saves_only) {
  for (std::size_t k = lines.size(); k > 0; --k)
    for (const std::string_view word : {kFrom, kSaves})
      if (lines[k - 1].starts_with(word) && !(saves_only && word == kFrom))
        return {k, lines[k - 1].substr(word.size())};
  return {};
}

bool is_journal_held(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool held = flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(descriptor);
  return held;
}

Journal::Journal(std::filesystem::path file) : file_(std::move(file)) {
  descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) fail_journal(file_, std::strerror(errno));
  const std::string whole = text_of_journal(file_);
  const char* why = nullptr;
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
    why = "another session has it open; close that one, or work on a copy";
  else if (ftruncate(descriptor_, off_t(whole.size())) != 0 || lseek(descriptor_, 0, SEEK_END) < 0)
    why = std::strerror(errno);
  if (!why) return;
  close(descriptor_);
  fail_journal(file_, why);
}

Journal::~Journal() { close(descriptor_); }

void Journal::append(const std::string& line) {
  const std::string bytes = line + "\n";
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t wrote = write(descriptor_, bytes.data() + done, bytes.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote < 0) fail_journal(file_, std::strerror(errno));
    done += std::size_t(wrote);
  }
  if (fdatasync(descriptor_) != 0) fail_journal(file_, std::strerror(errno));
}

void Journal::begin() {
  if (ftruncate(descriptor_, 0) != 0 || lseek(descriptor_, 0, SEEK_SET) < 0 ||
      fdatasync(descriptor_) != 0)
    fail_journal(file_, std::strerror(errno));
}

}  // namespace ecorche
