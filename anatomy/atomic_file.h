// Outputs are written beside their place and renamed: nothing half-written, nothing overwritten on failure.
#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

namespace ecorche {

// A file that appears under its name only when commit() succeeds; otherwise the temporary is removed and an older file stays.
// Throws OutputError: missing parent folder, a folder or a device in its place, no permission, disk full.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ofstream& stream() { return stream_; }
  // The temporary's path, for programs that write by themselves (close stream() first by calling release_stream()).
  const std::filesystem::path& temporary() const { return temporary_; }
  void release_stream() { stream_.close(); }
  void commit();

 private:
  std::filesystem::path file_, temporary_;
  std::ofstream stream_;
  bool committed_ = false;
};

// Before a long computation: throws OutputError where an AtomicFile would for a reason that can be known beforehand, or when the file
// is one of the inputs, under whatever name.
void check_output(const std::filesystem::path& file, const std::vector<std::filesystem::path>& inputs = {});

void write_file_atomically(const std::filesystem::path& file, std::string_view bytes);

}  // namespace ecorche
