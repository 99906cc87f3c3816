#include "anatomy/files/zip_archive.h"

#include <zip.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {

struct ZipArchive::Impl {
  std::string name;
  std::string bytes;  // libzip reads from here
  zip_t* zip = nullptr;
  std::mutex reading;  // a zip_t has one error state and one file position

  ~Impl() {
    if (zip) zip_discard(zip);
  }
};

ZipArchive::ZipArchive(std::string bytes, std::string name) : impl_(std::make_unique<Impl>()) {
  impl_->name = std::move(name);
  impl_->bytes = std::move(bytes);
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source =
      zip_source_buffer_create(impl_->bytes.data(), impl_->bytes.size(), 0, &error);
  if (source) impl_->zip = zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error);
  if (!impl_->zip) {
    const std::string reason = zip_error_strerror(&error);
    if (source) zip_source_free(source);
    zip_error_fini(&error);
    throw InputError(fmt::format("{}: not a readable zip file ({})", impl_->name, reason));
  }
  zip_error_fini(&error);
}

ZipArchive::~ZipArchive() = default;
ZipArchive::ZipArchive(ZipArchive&&) noexcept = default;
ZipArchive& ZipArchive::operator=(ZipArchive&&) noexcept = default;

std::vector<std::string> ZipArchive::names(std::string_view prefix) const {
  const std::scoped_lock lock(impl_->reading);
  std::vector<std::string> found;
  const zip_int64_t count = zip_get_num_entries(impl_->zip, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name = zip_get_name(impl_->zip, static_cast<zip_uint64_t>(i), 0);
    if (name && std::string_view(name).starts_with(prefix)) found.emplace_back(name);
  }
  std::sort(found.begin(), found.end());
  return found;
}

bool ZipArchive::contains(const std::string& entry) const {
  const std::scoped_lock lock(impl_->reading);
  return zip_name_locate(impl_->zip, entry.c_str(), 0) >= 0;
}

std::string ZipArchive::read(const std::string& entry, std::size_t limit) const {
  const std::scoped_lock lock(impl_->reading);
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_stat(impl_->zip, entry.c_str(), 0, &stat) != 0 || !(stat.valid & ZIP_STAT_SIZE)) {
    throw InputError(fmt::format("{}: entry '{}' is missing", impl_->name, entry));
  }
  if (stat.size > limit) {
    throw LimitError(fmt::format("{}: entry '{}' says {} bytes; at most {}", impl_->name, entry,
                                 stat.size, limit));
  }
  std::string bytes(stat.size, '\0');
  zip_file_t* in = zip_fopen(impl_->zip, entry.c_str(), 0);
  if (!in)
    throw InputError(
        fmt::format("{}: entry '{}': {}", impl_->name, entry, zip_strerror(impl_->zip)));
  const zip_int64_t got = zip_fread(in, bytes.data(), bytes.size());
  // Reading to the end makes libzip verify the entry's checksum.
  char beyond = 0;
  const bool ended = zip_fread(in, &beyond, 1) == 0;
  zip_fclose(in);
  if (got != static_cast<zip_int64_t>(stat.size) || !ended) {
    throw InputError(fmt::format("{}: entry '{}' is damaged: {} of {} bytes could be read",
                                 impl_->name, entry, got, stat.size));
  }
  return bytes;
}

}  // namespace ecorche::inline v1
