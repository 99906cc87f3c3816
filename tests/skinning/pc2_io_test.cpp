#include "skinning/pc2_io.h"

#include <gtest/gtest.h>

#include <fstream>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

class Pc2 : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("pc2_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    file_ = folder_ / "skin.pc2";
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& bytes) { std::ofstream(file_, std::ios::binary) << bytes; }
  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write_two_frames() {
    Pc2Writer writer(file_, 2, 3.0f, 0.5f);
    writer.add_frame(std::vector<float>{1, 2, 3, 1, 4, 5, 6, 1});
    writer.add_frame(std::vector<float>{-1, -2, -3, -4, -5, -6}, 3);
    writer.finish();
  }
  fs::path folder_, file_;
};

TEST_F(Pc2, RoundTripIsExact) {
  write_two_frames();
  const Pc2Cache cache = read_pc2(file_);
  EXPECT_EQ(cache.points, 2);
  EXPECT_EQ(cache.start_frame, 3.0f);
  EXPECT_EQ(cache.frame_step, 0.5f);
  ASSERT_EQ(cache.frames.size(), 2u);
  EXPECT_EQ(cache.frames[0], (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(cache.frames[1], (std::vector<float>{-1, -2, -3, -4, -5, -6}));
}

TEST_F(Pc2, LayoutIsTheFormats) {
  write_two_frames();
  const std::string raw = bytes();
  ASSERT_EQ(raw.size(), 32u + 2 * 2 * 12);
  EXPECT_EQ(raw.substr(0, 12), std::string("POINTCACHE2\0", 12));
  EXPECT_EQ(raw.substr(12, 8), std::string("\1\0\0\0\2\0\0\0", 8));
  EXPECT_EQ(raw.substr(28, 4), std::string("\2\0\0\0", 4));
  EXPECT_EQ(raw.substr(32, 4), std::string("\0\0\x80\x3f", 4));  // 1.0f
}

TEST_F(Pc2, NothingAppearsWithoutFinish) {
  {
    Pc2Writer writer(file_, 1);
    writer.add_frame(std::vector<float>{1, 2, 3, 1});
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Pc2, BadFilesAreRefused) {
  write_two_frames();
  const std::string good = bytes();
  EXPECT_THROW(read_pc2(folder_ / "missing.pc2"), InputError);
  EXPECT_THROW(read_pc2(file_, 10), LimitError);
  for (const std::size_t size : {0, 5, 31, 33, 79}) {
    write(good.substr(0, size));
    EXPECT_THROW(read_pc2(file_), InputError) << size;
  }
  std::string bad = good;
  bad[0] = 'X';
  write(bad);
  EXPECT_THROW(read_pc2(file_), InputError);
  bad = good;
  bad.replace(16, 4, std::string("\0\0\0\x80", 4));  // a negative count
  write(bad);
  EXPECT_THROW(read_pc2(file_), InputError);
  bad = good;
  bad.replace(28, 4, std::string("\xff\xff\xff\x7f", 4));  // more samples than the file holds
  write(bad);
  EXPECT_THROW(read_pc2(file_), InputError);
  bad = good;
  bad.replace(32, 4, std::string("\0\0\xc0\x7f", 4));  // NaN
  write(bad);
  EXPECT_THROW(read_pc2(file_), InputError);
}

TEST_F(Pc2, MissingFolderIsAnOutputError) { EXPECT_THROW(Pc2Writer(folder_ / "none" / "skin.pc2", 1), OutputError); }

}  // namespace
}  // namespace ecorche
