// Zip files held in memory; entries are inflated one by one.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ecorche::inline v1 {

// May be read by several threads; they wait for each other.
class ZipArchive {
 public:
  // `name` is what messages call the file. Throws InputError for what is no zip file, or whose
  // directory and entries contradict each other.
  ZipArchive(std::string bytes, std::string name);
  ~ZipArchive();
  ZipArchive(ZipArchive&&) noexcept;
  ZipArchive& operator=(ZipArchive&&) noexcept;

  // Entry names that start with `prefix`, sorted.
  std::vector<std::string> names(std::string_view prefix = "") const;
  bool contains(const std::string& entry) const;

  // The inflated bytes of an entry. Throws InputError when it is missing or damaged, LimitError
  // when it is larger than `limit`.
  std::string read(const std::string& entry, std::size_t limit) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche::inline v1
