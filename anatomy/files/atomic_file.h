// Outputs are written beside their place and renamed: nothing half-written, nothing overwritten on
// failure.
#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

namespace ecorche::inline v1 {

// A file that appears under its name only when commit() succeeds; otherwise the temporary is
// removed and an older file stays. A symbolic link stays a link: what it leads to is replaced.
// Temporaries are named .STEM.RANDOM.part.EXTENSION and locked (flock) while they are written.
// Those of runs that were killed are removed by the next run that writes a file of that name there.
// Throws OutputError that gives the system's reason: missing parent folder, a folder or a device in
// its place, no permission, disk full.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ofstream& stream() { return stream_; }
  // The temporary's path, for programs that write by themselves (close stream() first by calling
  // release_stream()).
  const std::filesystem::path& temporary() const { return temporary_; }
  void release_stream() { stream_.close(); }
  void commit();

  // Of a stream that has failed: throws OutputError with the system's reason.
  [[noreturn]] void fail() const;

 private:
  std::filesystem::path named_;  // as given, for messages
  std::filesystem::path file_;   // links followed
  std::filesystem::path temporary_;
  int lock_ = -1;  // descriptor that holds the temporary's lock
  std::ofstream stream_;
  bool committed_ = false;
};

// Before a long computation: throws OutputError where an AtomicFile would for a reason that can be
// known beforehand, or when the file is one of the inputs, under whatever name.
void check_output(const std::filesystem::path& file,
                  const std::vector<std::filesystem::path>& inputs = {});

// The same for all outputs of a command, which must also be different files.
void check_outputs(const std::vector<std::filesystem::path>& files,
                   const std::vector<std::filesystem::path>& inputs = {});

// Makes a folder and those above it that are missing. Throws OutputError as AtomicFile.
void make_output_folder(const std::filesystem::path& folder);

void write_file_atomically(const std::filesystem::path& file, std::string_view bytes);

// What a run has written so far, for one that is about to end.
struct WrittenFiles {
  std::vector<std::filesystem::path> complete;   // in the order of their commits
  std::vector<std::filesystem::path> abandoned;  // begun; their temporaries have been removed
};

// Removes all temporaries. Files begun or committed after it wait for ever, so that nothing appears
// while the program ends.
WrittenFiles abandon_writing();

}  // namespace ecorche::inline v1
