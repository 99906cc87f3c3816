// Outputs appear whole or not at all.
#include "anatomy/files/atomic_file.h"

#include <gtest/gtest.h>

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

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
  // A folder that is a link to /dev cannot take our temporary either; what matters is the error's
  // type.
  EXPECT_THROW(write_file_atomically("/dev/full/a.txt", "x"), OutputError);
}

TEST(AtomicFile, ALinkStaysALinkAndItsTargetIsReplaced) {
  const Folder folder;
  fs::create_directories(folder.path / "store");
  write_file_atomically(folder.path / "store" / "a.txt", "old");
  fs::create_symlink("store/a.txt", folder.path / "link.txt");
  write_file_atomically(folder.path / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder.path / "link.txt"));
  EXPECT_EQ(read(folder.path / "store" / "a.txt"), "new");
  fs::create_symlink("store/b.txt", folder.path / "dangling.txt");
  write_file_atomically(folder.path / "dangling.txt", "made");
  EXPECT_EQ(read(folder.path / "store" / "b.txt"), "made");
  fs::create_symlink("/dev/full", folder.path / "device.txt");
  EXPECT_THROW(write_file_atomically(folder.path / "device.txt", "x"), OutputError);
}

// What a run that was killed has left is removed by the next one; what another one is still writing
// is not.
TEST(AtomicFile, SweepsWhatTheKilledHaveLeft) {
  const Folder folder;
  const pid_t child = fork();
  if (child == 0) {
    AtomicFile* out = new AtomicFile(folder.path / "a.txt");
    out->stream() << "half" << std::flush;
    _exit(0);  // as by SIGKILL: no destructor runs
  }
  waitpid(child, nullptr, 0);
  ASSERT_EQ(folder.count(), 1) << "the child should have left its temporary";
  AtomicFile other(folder.path / "a.txt");
  EXPECT_EQ(folder.count(), 1) << "the child's temporary is gone, the new one is there";
  AtomicFile second(folder.path / "a.txt");
  EXPECT_EQ(folder.count(), 2) << "the first one is still being written";
  other.stream() << "other";
  second.stream() << "second";
  other.commit();
  second.commit();
  EXPECT_EQ(read(folder.path / "a.txt"), "second");
}

// A temporary that has just been made and has no lock yet looks like one of the killed.
TEST(AtomicFile, WritersOfOneFileNeverSweepEachOther) {
  const Folder folder;
  constexpr int kWriters = 4, kFiles = 300;
  pid_t children[kWriters];
  for (pid_t& child : children)
    if ((child = fork()) == 0) {
      try {
        for (int i = 0; i < kFiles; ++i) write_file_atomically(folder.path / "a.txt", "whole");
      } catch (const OutputError&) {
        _exit(1);
      }
      _exit(0);
    }
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0) << "a writer's temporary was gone before it was renamed";
  }
  EXPECT_EQ(read(folder.path / "a.txt"), "whole");
  EXPECT_EQ(folder.count(), 1);
}

TEST(AtomicFile, TellsTheSystemsReason) {
  const Folder folder;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  signal(SIGXFSZ, SIG_IGN);
  std::string why;
  try {
    write_file_atomically(folder.path / "a.txt", std::string(100000, 'x'));
  } catch (const OutputError& e) {
    why = e.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_NE(why.find("File too large"), std::string::npos) << why;
  EXPECT_EQ(folder.count(), 0);
}

TEST(AtomicFile, OutputsOfACommandAreDifferentFilesAndNoInputs) {
  const Folder folder;
  write_file_atomically(folder.path / "in.txt", "x");
  const fs::path a = folder.path / "a.txt", same = folder.path / "." / "a.txt";
  EXPECT_NO_THROW(check_outputs({a, folder.path / "b.txt", {}}, {folder.path / "in.txt", {}}));
  EXPECT_THROW(check_outputs({a, same}), OutputError);
  EXPECT_THROW(check_outputs({folder.path / "in.txt"}, {folder.path / "in.txt"}), OutputError);
}
