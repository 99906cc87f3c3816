#include "skinning/mdd_io.h"

#include <gtest/gtest.h>

#include <fstream>

#include "anatomy/errors.h"
#include "anatomy/mesh_io.h"
#include "skinning/obj_sequence.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

class Caches : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("caches_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    file_ = folder_ / "skin.mdd";
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& bytes) { std::ofstream(file_, std::ios::binary) << bytes; }
  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write_two_frames() {
    MddWriter writer(file_, 2, 2, 4);
    writer.add_frame(std::vector<float>{1, 2, 3, 1, 4, 5, 6, 1});
    writer.add_frame(std::vector<float>{-1, -2, -3, -4, -5, -6}, 3);
    writer.finish();
  }
  fs::path folder_, file_;
};

TEST_F(Caches, MddComesBackExactly) {
  write_two_frames();
  const MddCache cache = read_mdd(file_);
  EXPECT_EQ(cache.points, 2);
  EXPECT_EQ(cache.seconds, (std::vector<float>{0, 0.25f}));
  ASSERT_EQ(cache.frames.size(), 2u);
  EXPECT_EQ(cache.frames[0], (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(cache.frames[1], (std::vector<float>{-1, -2, -3, -4, -5, -6}));
}

TEST_F(Caches, MddLayoutIsTheFormats) {
  write_two_frames();
  const std::string raw = bytes();
  ASSERT_EQ(raw.size(), 8u + 2 * 4 + 2 * 2 * 12);
  EXPECT_EQ(raw.substr(0, 8), std::string("\0\0\0\2\0\0\0\2", 8));
  EXPECT_EQ(raw.substr(12, 4), std::string("\x3e\x80\0\0", 4));  // 0.25f
  EXPECT_EQ(raw.substr(16, 4), std::string("\x3f\x80\0\0", 4));  // 1.0f
}

TEST_F(Caches, NothingAppearsUnlessAllPromisedFramesCame) {
  {
    MddWriter writer(file_, 1, 2, 25);
    writer.add_frame(std::vector<float>{1, 2, 3, 1});
    EXPECT_THROW(writer.finish(), std::invalid_argument);
    EXPECT_THROW(writer.add_frame(std::vector<float>{1, 2, 3}), std::invalid_argument);
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Caches, BadMddFilesAreRefused) {
  write_two_frames();
  const std::string good = bytes();
  EXPECT_THROW(read_mdd(folder_ / "missing.mdd"), InputError);
  EXPECT_THROW(read_mdd(file_, 10), LimitError);
  for (const std::size_t size : {0, 5, 9, 17, 63}) {
    write(good.substr(0, size));
    EXPECT_THROW(read_mdd(file_), InputError) << size;
  }
  for (const std::size_t at : {0, 4})
    for (const std::string& count : {std::string("\xff\xff\xff\xff", 4), std::string("\x7f\xff\xff\xff", 4), std::string("\0\0\0\0", 4)}) {
      std::string bad = good;
      bad.replace(at, 4, count);
      write(bad);
      EXPECT_THROW(read_mdd(file_), InputError) << at;
    }
  for (const std::size_t at : {8, 16}) {
    std::string bad = good;
    bad.replace(at, 4, std::string("\x7f\xc0\0\0", 4));  // NaN
    write(bad);
    EXPECT_THROW(read_mdd(file_), InputError) << at;
  }
}

TEST_F(Caches, ObjSequenceReadsBackExactly) {
  Triangles F(1, 3);
  F << 0, 1, 2;
  ObjSequenceWriter writer(folder_ / "frames" / "%03d.obj", F);
  writer.add_frame(std::vector<float>{0.1f, 0, 0, 1, 1, 0, 1e-7f, 1, 0, 1, 0, 1});
  writer.add_frame(std::vector<float>{0, 0, 3, 1, 0, 3, 0, 1.0f / 3, 3}, 3);
  EXPECT_EQ(writer.name(2), folder_ / "frames" / "002.obj");
  const TriMesh one = read_mesh(folder_ / "frames" / "001.obj"), two = read_mesh(folder_ / "frames" / "002.obj");
  EXPECT_EQ(one.F, F);
  EXPECT_EQ(static_cast<float>(one.V(0, 0)), 0.1f);
  EXPECT_EQ(static_cast<float>(one.V(1, 2)), 1e-7f);
  EXPECT_EQ(static_cast<float>(two.V(2, 1)), 1.0f / 3);
  EXPECT_THROW(writer.add_frame(std::vector<float>{0, 0, 0}), std::invalid_argument);
  EXPECT_FALSE(fs::exists(folder_ / "frames" / "003.obj"));
}

TEST_F(Caches, ObjSequencesNeedANumberAndAFolder) {
  const Triangles F(0, 3);
  for (const char* name : {"a.obj", "%04d.ply", "%04f.obj", "%d%d.obj", "%99999d.obj"}) EXPECT_THROW(ObjSequenceWriter(folder_ / name, F), UsageError) << name;
  EXPECT_THROW(ObjSequenceWriter(folder_ / "no" / "where" / "%d.obj", F), OutputError);
}

}  // namespace
}  // namespace ecorche
