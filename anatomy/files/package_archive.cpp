#include "anatomy/files/package_archive.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/zip_archive.h"

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
  ZipArchive zip;
};

PackageArchive::PackageArchive(const Packages& packages, std::string_view name) {
  const PinnedPackage pin = find_pin(packages.pins, name);
  *this = PackageArchive(packages.folder / wheel_name(pin), pin);
}

PackageArchive::PackageArchive(const fs::path& file, const PinnedPackage& pin) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    throw InputError(fmt::format(
        "{}: the data package {} {} is missing (sha256 {}); run `make setup` (where ecorche "
        "is installed, `setup.sh --packages` in its share/ecorche/data), or set "
        "ECORCHE_PACKAGES to the folder that holds it",
        file.string(), pin.name, pin.version, pin.sha256));
  }
  std::string bytes = read_bytes(file);
  if (const std::string found = sha256(bytes); found != pin.sha256) {
    throw InputError(fmt::format(
        "{}: not the pinned data package: expected sha256 {}, found {}; delete the file and run "
        "`make setup`",
        file.string(), pin.sha256, found));
  }
  const std::string name = file.filename().string();
  impl_ = std::make_unique<Impl>(Impl{name, pin.sha256, ZipArchive(std::move(bytes), name)});
}

PackageArchive::~PackageArchive() = default;
PackageArchive::PackageArchive(PackageArchive&&) noexcept = default;
PackageArchive& PackageArchive::operator=(PackageArchive&&) noexcept = default;

const std::string& PackageArchive::file_name() const { return impl_->file; }
const std::string& PackageArchive::hash() const { return impl_->hash; }

std::vector<std::string> PackageArchive::names(std::string_view prefix) const {
  return impl_->zip.names(prefix);
}

bool PackageArchive::contains(const std::string& entry) const { return impl_->zip.contains(entry); }

std::string PackageArchive::read(const std::string& entry) const {
  return impl_->zip.read(entry, kLargestEntry);
}

}  // namespace ecorche::inline v1
