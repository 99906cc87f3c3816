// Vertex caches: PC2, MDD, OBJ sequences.
#include <gtest/gtest.h>

#include <fstream>

#include "anatomy/errors.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "skinning/files/mdd_io.h"
#include "skinning/files/obj_sequence.h"
#include "skinning/files/pc2_io.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

class Caches : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("caches_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& bytes) { std::ofstream(file_, std::ios::binary) << bytes; }
  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  template <class Writer>
  static void add_two_frames(Writer writer) {
    writer.add_frame(std::vector<float>{1, 2, 3, 1, 4, 5, 6, 1});
    writer.add_frame(std::vector<float>{-1, -2, -3, -4, -5, -6}, 3);
    writer.finish();
  }
  // A file of two frames: missing, larger than allowed, cut off at these sizes.
  template <class Read>
  void expect_refused(const Read& read, std::initializer_list<std::size_t> sizes) {
    const std::string good = bytes();
    EXPECT_THROW(read(folder_ / "missing", 1 << 20), InputError);
    EXPECT_THROW(read(file_, 10), LimitError);
    for (const std::size_t size : sizes) {
      write(good.substr(0, size));
      EXPECT_THROW(read(file_, 1 << 20), InputError) << size;
    }
  }
  template <class Cache>
  static void expect_two_frames(const Cache& cache) {
    EXPECT_EQ(cache.points, 2);
    ASSERT_EQ(cache.frames.size(), 2u);
    EXPECT_EQ(cache.frames[0], (std::vector<float>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(cache.frames[1], (std::vector<float>{-1, -2, -3, -4, -5, -6}));
  }
  fs::path folder_, file_;
};

class Mdd : public Caches {
 protected:
  void SetUp() override {
    Caches::SetUp();
    file_ = folder_ / "skin.mdd";
  }
  void write_two_frames() { add_two_frames(MddWriter(file_, 2, 2, 4)); }
};

class Pc2 : public Caches {
 protected:
  void SetUp() override {
    Caches::SetUp();
    file_ = folder_ / "skin.pc2";
  }
  void write_two_frames() { add_two_frames(Pc2Writer(file_, 2, 3.0f, 0.5f)); }
};

using ObjSequence = Caches;

TEST_F(Pc2, RoundTripIsExact) {
  write_two_frames();
  const Pc2Cache cache = read_pc2(file_);
  expect_two_frames(cache);
  EXPECT_EQ(cache.start_frame, 3.0f);
  EXPECT_EQ(cache.frame_step, 0.5f);
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
  expect_refused(read_pc2, {0, 5, 31, 33, 79});
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

TEST_F(Pc2, MissingFolderIsAnOutputError) {
  EXPECT_THROW(Pc2Writer(folder_ / "none" / "skin.pc2", 1), OutputError);
}

TEST_F(Mdd, ComesBackExactly) {
  write_two_frames();
  const MddCache cache = read_mdd(file_);
  expect_two_frames(cache);
  EXPECT_EQ(cache.seconds, (std::vector<float>{0, 0.25f}));
}

TEST_F(Mdd, LayoutIsTheFormats) {
  write_two_frames();
  const std::string raw = bytes();
  ASSERT_EQ(raw.size(), 8u + 2 * 4 + 2 * 2 * 12);
  EXPECT_EQ(raw.substr(0, 8), std::string("\0\0\0\2\0\0\0\2", 8));
  EXPECT_EQ(raw.substr(12, 4), std::string("\x3e\x80\0\0", 4));  // 0.25f
  EXPECT_EQ(raw.substr(16, 4), std::string("\x3f\x80\0\0", 4));  // 1.0f
}

TEST_F(Mdd, NothingAppearsUnlessAllPromisedFramesCame) {
  {
    MddWriter writer(file_, 1, 2, 25);
    writer.add_frame(std::vector<float>{1, 2, 3, 1});
    EXPECT_THROW(writer.finish(), std::invalid_argument);
    EXPECT_THROW(writer.add_frame(std::vector<float>{1, 2, 3}), std::invalid_argument);
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Mdd, BadFilesAreRefused) {
  write_two_frames();
  const std::string good = bytes();
  expect_refused(read_mdd, {0, 5, 9, 17, 63});
  for (const std::size_t at : {0, 4})
    for (const std::string& count :
         {std::string("\xff\xff\xff\xff", 4), std::string("\x7f\xff\xff\xff", 4),
          std::string("\0\0\0\0", 4)}) {
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

TEST_F(ObjSequence, ReadsBackExactly) {
  Triangles F(1, 3);
  F << 0, 1, 2;
  ObjSequenceWriter writer(folder_ / "frames" / "%03d.obj", F);
  writer.add_frame(std::vector<float>{0.1f, 0, 0, 1, 1, 0, 1e-7f, 1, 0, 1, 0, 1});
  writer.add_frame(std::vector<float>{0, 0, 3, 1, 0, 3, 0, 1.0f / 3, 3}, 3);
  EXPECT_EQ(writer.name(2), folder_ / "frames" / "002.obj");
  const TriMesh one = read_mesh(folder_ / "frames" / "001.obj"),
                two = read_mesh(folder_ / "frames" / "002.obj");
  EXPECT_EQ(one.F, F);
  EXPECT_EQ(float(one.V(0, 0)), 0.1f);
  EXPECT_EQ(float(one.V(1, 2)), 1e-7f);
  EXPECT_EQ(float(two.V(2, 1)), 1.0f / 3);
  EXPECT_THROW(writer.add_frame(std::vector<float>{0, 0, 0}), std::invalid_argument);
  EXPECT_FALSE(fs::exists(folder_ / "frames" / "003.obj"));
}

TEST_F(ObjSequence, NeedsANumberAndMakesItsFolder) {
  const Triangles F(0, 3);
  for (const char* name : {"a.obj", "%04d.ply", "%04f.obj", "%d%d.obj", "%99999d.obj"})
    EXPECT_THROW(ObjSequenceWriter(folder_ / name, F), UsageError) << name;
  ObjSequenceWriter(folder_ / "not" / "yet" / "%d.obj", F);
  EXPECT_TRUE(fs::is_directory(folder_ / "not" / "yet"));
  std::ofstream(folder_ / "file") << "in the way";
  EXPECT_THROW(ObjSequenceWriter(folder_ / "file" / "%d.obj", F), OutputError);
}

}  // namespace
}  // namespace ecorche
