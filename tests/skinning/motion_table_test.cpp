// Tables of motions as files.
#include "skinning/motion_files/motion_table.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

class Tables : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string written(const std::string& name) const {
    std::ifstream in(folder_ / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  fs::path folder_ = fs::path(::testing::TempDir()) / ("tables_" + std::to_string(::getpid()));
};

const MotionTable kLengths{"lengths of muscles",         "m", {"a_l", "a_r"}, {}, 4,
                           {{0.25, 0.5}, {-1e-9, 0.125}}};

TEST_F(Tables, CsvHasUnitsInItsHeadings) {
  write_motion_table(folder_ / "a.csv", kLengths);
  EXPECT_EQ(
      written("a.csv"),
      "time [s],a_l [m],a_r [m]\n0.0000000,0.2500000,0.5000000\n0.2500000,0.0000000,0.1250000\n");
  MotionTable mixed = kLengths;
  mixed.unit = "deg";
  mixed.units = {"deg", ""};
  write_motion_table(folder_ / "b.csv", mixed);
  EXPECT_TRUE(written("b.csv").starts_with("time [s],a_l [deg],a_r\n"));
}

TEST_F(Tables, OpenSimsSayHowManyAndWhetherDegrees) {
  write_motion_table(folder_ / "a.sto", kLengths);
  EXPECT_EQ(
      written("a.sto"),
      "lengths of "
      "muscles\nversion=1\nnRows=2\nnColumns=3\ninDegrees=no\nunits=m\nendheader\ntime\ta_l\ta_r\n"
      "0.0000000\t0.2500000\t0.5000000\n0.2500000\t0.0000000\t0.1250000\n");
  MotionTable angles = kLengths;
  angles.unit = "deg";
  write_motion_table(folder_ / "a.mot", angles);
  EXPECT_NE(written("a.mot").find("inDegrees=yes\nendheader\n"), std::string::npos);
  EXPECT_THROW(write_motion_table(folder_ / "a.txt", kLengths), UsageError);
  EXPECT_THROW(write_motion_table(folder_ / "no" / "a.csv", kLengths), OutputError);
}

TEST_F(Tables, MarkersAreInOpenSimsAxes) {
  MarkerMotion markers{{"here", "there"}, 50, {Points(2, 3), Points(2, 3)}};
  markers.frames[0] << 1, 2, 3, 0, 0, 0;  // left, up, forward
  markers.frames[1] << -0.5, 0, 0, 4, 5, 6;
  write_trc(folder_ / "a.trc", markers);
  const std::string text = written("a.trc");
  EXPECT_TRUE(text.starts_with("PathFileType\t4\t(X/Y/Z)\ta.trc\n"));
  EXPECT_NE(text.find("50\t50\t2\t2\tm\t50\t1\t2\nFrame#"
                      "\tTime\there\t\t\tthere\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n"),
            std::string::npos);
  EXPECT_NE(text.find("\n1\t0.0000000\t3.0000000\t2.0000000\t-1.0000000\t"), std::string::npos);
  EXPECT_NE(
      text.find(
          "\n2\t0.0200000\t0.0000000\t0.0000000\t0.5000000\t6.0000000\t5.0000000\t-4.0000000\n"),
      std::string::npos);
}

}  // namespace
}  // namespace ecorche
