// Outputs appear whole or not at all.
#include "anatomy/atomic_file.h"

#include <gtest/gtest.h>

#include <iterator>

#include "anatomy/errors.h"

using namespace ecorche;
namespace fs = std::filesystem;

namespace {

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Folder {
  fs::path path = fs::temp_directory_path() / ("ecorche-atomic-" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  long count() const { return std::distance(fs::directory_iterator(path), {}); }
};

}  // namespace

TEST(AtomicFile, WritesAndReplaces) {
  const Folder folder;
  write_file_atomically(folder.path / "a.txt", "one");
  write_file_atomically(folder.path / "a.txt", "two");
  EXPECT_EQ(read(folder.path / "a.txt"), "two");
  EXPECT_EQ(folder.count(), 1);
}

TEST(AtomicFile, WithoutCommitTheOldFileStaysAndNothingElse) {
  const Folder folder;
  write_file_atomically(folder.path / "a.txt", "old");
  {
    AtomicFile out(folder.path / "a.txt");
    out.stream() << "half";
  }
  EXPECT_EQ(read(folder.path / "a.txt"), "old");
  EXPECT_EQ(folder.count(), 1);
}

TEST(AtomicFile, RefusesFoldersAndMissingParents) {
  const Folder folder;
  EXPECT_THROW(write_file_atomically(folder.path, "x"), OutputError);
  EXPECT_THROW(write_file_atomically(folder.path / "no" / "a.txt", "x"), OutputError);
}

TEST(AtomicFile, AFullDiskIsAnOutputError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  // A folder that is a link to /dev cannot take our temporary either; what matters is the error's type.
  EXPECT_THROW(write_file_atomically("/dev/full/a.txt", "x"), OutputError);
}
