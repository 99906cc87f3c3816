// Files in memory, for what goes to another program and comes back.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

namespace ecorche::inline v1 {

// Every member throws LimitError where the system has no memory for it: "<what>: no memory for the
// other program's data: ...".
class MemoryFile {
 public:
  explicit MemoryFile(std::string what);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }
  void write_all(std::string_view bytes);  // and back to the beginning
  std::string read_all(std::size_t most = std::numeric_limits<std::size_t>::max()) const;

 private:
  [[noreturn]] void fail() const;

  std::string what_;
  int descriptor_;
};

}  // namespace ecorche::inline v1
