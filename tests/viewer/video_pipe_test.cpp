// A film is whole or not there, whatever the program that encodes it does.
#include "viewer/film/video_pipe.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "anatomy/errors.h"
#include "viewer/film/film_check.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 320, kHeight = 200, kFrames = 7;

class VideoPipeTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("ecorche_video_{}", ::getpid());
    fs::create_directories(folder_ / "out");
  }
  void TearDown() override { fs::remove_all(folder_); }

  // A program of the given lines of shell; its last argument is the film.
  std::string script(const std::string& lines) const {
    const fs::path file = folder_ / "program";
    std::ofstream(file) << "#!/bin/bash\nfilm=${@: -1}\n" << lines << "\n";
    fs::permissions(file, fs::perms::owner_all);
    return file.string();
  }
  fs::path film() const { return folder_ / "out" / "film.mp4"; }

  // What goes wrong; empty: nothing.
  std::string make(const std::string& program, double patience = 60) const try {
    VideoPipe pipe(film(), kWidth, kHeight, {.fps = 25, .program = program, .patience = patience});
    Image image = make_image(kWidth, kHeight);
    std::mt19937 noise(1);  // so that the film is large
    for (int f = 0; f < kFrames; ++f) {
      for (std::uint8_t& value : image.rgba) value = std::uint8_t(noise() >> 24);
      pipe.add(image);
    }
    pipe.finish();
    return {};
  } catch (const OutputError& error) {
    return error.what();
  }
  bool left_nothing() const { return fs::is_empty(folder_ / "out"); }
  static bool has_ffmpeg() { return std::system("ffmpeg -version > /dev/null 2>&1") == 0; }

  fs::path folder_;
};

bool says(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

TEST_F(VideoPipeTest, a_program_that_fails_gives_its_own_reason) {
  const std::string why =
      make(script("cat > /dev/null; echo 'No space left on the moon' >&2; exit 3"));
  EXPECT_TRUE(says(why, "exit code 3") && says(why, "No space left on the moon")) << why;
  const std::string early = make(script("echo 'unknown encoder' >&2; exit 8"));
  EXPECT_TRUE(says(early, "exit code 8") && says(early, "unknown encoder")) << early;
  EXPECT_TRUE(left_nothing());
}

TEST_F(VideoPipeTest, a_program_that_writes_nothing_is_no_success) {
  const std::string why = make(script("cat > /dev/null"));
  EXPECT_TRUE(says(why, "empty")) << why;
  EXPECT_TRUE(says(make(script("cat > /dev/null; echo film > \"$film\"")), "breaks off"));
  EXPECT_TRUE(left_nothing());
}

TEST_F(VideoPipeTest, a_program_that_hangs_is_ended_with_all_that_it_started) {
  const auto start = std::chrono::steady_clock::now();
  const std::string deaf =
      make(script("sleep 1000 & echo $! > " + (folder_ / "started").string() + "; wait"), 0.3);
  EXPECT_TRUE(says(deaf, "has read nothing")) << deaf;
  const std::string endless = make(script("cat > /dev/null; sleep 1000"), 0.3);
  EXPECT_TRUE(says(endless, "has not ended")) << endless;
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
  EXPECT_TRUE(left_nothing());
  std::string started;
  std::ifstream(folder_ / "started") >> started;
  ASSERT_FALSE(started.empty());
  // Gone, or ended and not yet collected by whoever inherited it.
  std::ifstream state("/proc/" + started + "/stat");
  const std::string line{std::istreambuf_iterator<char>(state), {}};
  EXPECT_TRUE(line.empty() || says(line, ") Z")) << line;
}

TEST_F(VideoPipeTest, a_slow_program_is_waited_for) {
  if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg";
  EXPECT_EQ(make(script("sleep 0.5; ffmpeg \"$@\""), 5), "");
  EXPECT_EQ(film_fault(film(), kFrames), "");
}

TEST_F(VideoPipeTest, a_film_that_lacks_a_picture_or_a_byte_is_not_whole) {
  if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg";
  ASSERT_EQ(make("ffmpeg"), "");
  EXPECT_EQ(film_fault(film(), kFrames), "");
  EXPECT_TRUE(says(film_fault(film(), kFrames + 1), "7 pictures of 8"));
  const auto bytes = fs::file_size(film());
  for (const auto kept :
       {bytes - 1, bytes / 2, bytes / 10, std::uintmax_t{40}, std::uintmax_t{5}}) {
    const fs::path cut = folder_ / "cut.mp4";
    fs::copy_file(film(), cut, fs::copy_options::overwrite_existing);
    fs::resize_file(cut, kept);
    EXPECT_NE(film_fault(cut, kFrames), "") << kept << " bytes of " << bytes;
  }
  EXPECT_NE(film_fault(folder_ / "none.mp4", kFrames), "");
  // A film of fewer frames than were sent.
  EXPECT_TRUE(
      says(make(script("head -c 400000 | ffmpeg \"$@\" 2> /dev/null; cat > /dev/null; exit 0")),
           "not whole"));
}

TEST_F(VideoPipeTest, a_full_disk_is_said) {
  if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg";
  // As a disk that is full: no file may grow beyond 8 kB.
  const std::string why = make(script("trap '' XFSZ; ulimit -f 8; ffmpeg \"$@\"; exit 0"));
  EXPECT_TRUE(says(why, "not whole")) << why;
  EXPECT_TRUE(left_nothing());
}

}  // namespace
}  // namespace ecorche
