#include "anatomy/files/package_archive.h"

#include <openssl/evp.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <mutex>
#include <sstream>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kLargestPackage = 1ull << 30;
constexpr std::uint64_t kLargestEntry = 512ull << 20;

std::string read_bytes(const fs::path& file) {
  std::error_code failure;
  const auto size = fs::file_size(file, failure);
  if (failure)
    throw InputError(fmt::format("{}: cannot be read ({})", file.string(), failure.message()));
  if (size > kLargestPackage)
    throw LimitError(fmt::format("{}: {} bytes; at most {}", file.string(), size, kLargestPackage));
  std::string bytes(size, '\0');
  std::ifstream in(file, std::ios::binary);
  if (!in.read(bytes.data(), std::streamsize(size))) {
    throw InputError(fmt::format("{}: cannot be read", file.string()));
  }
  return bytes;
}

bool is_sha256(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

PinnedPackage find_pin(const fs::path& list, std::string_view name) {
  for (const PinnedPackage& pin : read_pins(list)) {
    if (pin.name == name) return pin;
  }
  throw InputError(
      fmt::format("{}: package '{}' is not pinned; add a line name==version --hash=sha256:HEX",
                  list.string(), name));
}

}  // namespace

std::vector<PinnedPackage> read_pins(const fs::path& requirements) {
  std::ifstream in(requirements);
  if (!in) throw InputError(fmt::format("{}: cannot be read", requirements.string()));
  std::vector<PinnedPackage> pins;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string what, hash, more;
    if (!(words >> what)) continue;
    const std::string prefix = "--hash=sha256:";
    const std::size_t equals = what.find("==");
    PinnedPackage pin;
    if (words >> hash && !(words >> more) && hash.starts_with(prefix) &&
        equals != std::string::npos && equals > 0) {
      pin = {what.substr(0, equals), what.substr(equals + 2), hash.substr(prefix.size())};
    }
    if (pin.version.empty() || !is_sha256(pin.sha256)) {
      throw InputError(fmt::format(
          "{}:{}: '{}'; expected name==version --hash=sha256:HEX with 64 lower-case digits",
          requirements.string(), number, line));
    }
    pins.push_back(pin);
  }
  return pins;
}

std::string wheel_name(const PinnedPackage& pin) {
  std::string name = pin.name;
  std::replace(name.begin(), name.end(), '-', '_');  // as wheels spell it
  return fmt::format("{}-{}-py3-none-any.whl", name, pin.version);
}

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("sha256 failed");
  }
  std::string hex;
  for (unsigned i = 0; i < length; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

struct PackageArchive::Impl {
  std::string file;  // name without folder
  std::string hash;
  std::string bytes;  // libzip reads from here
  zip_t* zip = nullptr;
  std::mutex reading;  // a zip_t has one error state and one file position

  ~Impl() {
    if (zip) zip_discard(zip);
  }
};

PackageArchive::PackageArchive(const Packages& packages, std::string_view name) {
  const PinnedPackage pin = find_pin(packages.pins, name);
  *this = PackageArchive(packages.folder / wheel_name(pin), pin);
}

PackageArchive::PackageArchive(const fs::path& file, const PinnedPackage& pin)
    : impl_(std::make_unique<Impl>()) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    throw InputError(fmt::format(
        "{}: the data package {} {} is missing (sha256 {}); run `make setup` (where ecorche "
        "is installed, `setup.sh --packages` in its share/ecorche/data), or set "
        "ECORCHE_PACKAGES to the folder that holds it",
        file.string(), pin.name, pin.version, pin.sha256));
  }
  impl_->file = file.filename().string();
  impl_->hash = pin.sha256;
  impl_->bytes = read_bytes(file);
  if (const std::string found = sha256(impl_->bytes); found != pin.sha256) {
    throw InputError(fmt::format(
        "{}: not the pinned data package: expected sha256 {}, found {}; delete the file and run "
        "`make setup`",
        file.string(), pin.sha256, found));
  }
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source =
      zip_source_buffer_create(impl_->bytes.data(), impl_->bytes.size(), 0, &error);
  if (source) impl_->zip = zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error);
  if (!impl_->zip) {
    const std::string reason = zip_error_strerror(&error);
    if (source) zip_source_free(source);
    zip_error_fini(&error);
    throw InputError(fmt::format("{}: not a readable zip file ({})", file.string(), reason));
  }
  zip_error_fini(&error);
}

PackageArchive::~PackageArchive() = default;
PackageArchive::PackageArchive(PackageArchive&&) noexcept = default;
PackageArchive& PackageArchive::operator=(PackageArchive&&) noexcept = default;

const std::string& PackageArchive::file_name() const { return impl_->file; }
const std::string& PackageArchive::hash() const { return impl_->hash; }

std::vector<std::string> PackageArchive::names(std::string_view prefix) const {
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

bool PackageArchive::contains(const std::string& entry) const {
  const std::scoped_lock lock(impl_->reading);
  return zip_name_locate(impl_->zip, entry.c_str(), 0) >= 0;
}

std::string PackageArchive::read(const std::string& entry) const {
  const std::scoped_lock lock(impl_->reading);
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_stat(impl_->zip, entry.c_str(), 0, &stat) != 0 || !(stat.valid & ZIP_STAT_SIZE)) {
    throw InputError(fmt::format("{}: entry '{}' is missing", impl_->file, entry));
  }
  if (stat.size > kLargestEntry) {
    throw LimitError(fmt::format("{}: entry '{}' says {} bytes; at most {}", impl_->file, entry,
                                 stat.size, kLargestEntry));
  }
  std::string bytes(stat.size, '\0');
  zip_file_t* in = zip_fopen(impl_->zip, entry.c_str(), 0);
  if (!in)
    throw InputError(
        fmt::format("{}: entry '{}': {}", impl_->file, entry, zip_strerror(impl_->zip)));
  const zip_int64_t got = zip_fread(in, bytes.data(), bytes.size());
  // Reading to the end makes libzip verify the entry's checksum.
  char beyond = 0;
  const bool ended = zip_fread(in, &beyond, 1) == 0;
  zip_fclose(in);
  if (got != static_cast<zip_int64_t>(stat.size) || !ended) {
    throw InputError(fmt::format("{}: entry '{}' is damaged: {} of {} bytes could be read",
                                 impl_->file, entry, got, stat.size));
  }
  return bytes;
}

}  // namespace ecorche::inline v1
