// The reader's promises on a corpus of bad files, on generated monsters, and on every real file
// that is at hand.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "anatomy/errors.h"
#include "skinning/motion_files/bvh_read.h"
#include "skinning/motion_files/bvh_write.h"

using namespace ecorche;
namespace fs = std::filesystem;

namespace {

const fs::path kCorpus = fs::path(ECORCHE_TEST_DIR) / "corpus" / "bvh";

struct Expected {
  std::string file, outcome;
};

std::vector<Expected> expectations() {
  std::ifstream stream(kCorpus / "expected.txt");
  std::vector<Expected> out;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') continue;
    const size_t bar = line.find(" | ");
    out.push_back({line.substr(0, bar), line.substr(bar + 3)});
  }
  return out;
}

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string chain(int depth) {
  std::string text = "HIERARCHY\n";
  for (int k = 0; k < depth; ++k)
    text += fmt::format("{} j{}\n{{\nOFFSET 0 1 0\n", k == 0 ? "ROOT" : "JOINT", k);
  text.append(depth, '}');
  return text + "\nMOTION\nFrames: 0\nFrame Time: 0.01\n";
}

std::string star(int joints) {
  std::string text = "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\n";
  for (int k = 1; k < joints; ++k) text += fmt::format("JOINT j{} {{ OFFSET 0 1 0 }}\n", k);
  return text + "}\nMOTION\nFrames: 0\nFrame Time: 0.01\n";
}

const char* kTwoJoints =
    "HIERARCHY\nROOT a\n{\nOFFSET 1 2 3\nCHANNELS 6 Zrotation Yrotation Xrotation Xposition "
    "Yposition Zposition\nJOINT "
    "b\n{\nOFFSET 0 2 0\n"
    "CHANNELS 4 Yposition Xrotation Zrotation Yrotation\nEnd Site\n{\nOFFSET 0 1 "
    "0\n}\n}\n}\nMOTION\nFrames: 1\nFrame Time: "
    "0.0333333\n"
    "30 20 10 5 6 7 3 40 50 60\n";

}  // namespace

TEST(BvhCorpus, EveryFileHasItsStatedOutcome) {
  const auto all = expectations();
  ASSERT_GT(all.size(), 70u);
  for (const Expected& expected : all) {
    SCOPED_TRACE(expected.file);
    std::istringstream words(expected.outcome);
    std::string kind;
    words >> kind;
    if (kind == "ok") {
      int joints = 0, frames = 0, warnings = 0;
      double fps = 0;
      words >> joints >> frames >> fps >> warnings;
      try {
        const BvhMotion motion = read_bvh(kCorpus / expected.file);
        EXPECT_EQ(int(motion.joints.size()), joints);
        EXPECT_EQ(motion.frames, frames);
        EXPECT_NEAR(motion.fps, fps, 1e-7);
        EXPECT_EQ(int(motion.warnings.size()), warnings)
            << fmt::format("{}", fmt::join(motion.warnings, "\n"));
        EXPECT_EQ(motion.samples.size(), std::size_t(motion.frames) * motion.channels);
      } catch (const std::exception& e) {
        ADD_FAILURE() << e.what();
      }
    } else {
      int line = 0;
      std::string text;
      words >> line;
      std::getline(words >> std::ws, text);
      try {
        read_bvh(kCorpus / expected.file);
        ADD_FAILURE() << "was accepted";
      } catch (const InputError& e) {
        const std::string message = e.what();
        EXPECT_NE(message.find(text), std::string::npos) << message;
        EXPECT_NE(message.find(expected.file + ":" + (line > 0 ? std::to_string(line) + ":" : "")),
                  std::string::npos)
            << message;
      }
    }
  }
}

TEST(BvhCorpus, EveryFileIsListed) {
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(kCorpus))
    files += entry.path().extension() == ".bvh";
  EXPECT_EQ(files, expectations().size());
}

// Every prefix of a good file, and the file with every byte changed, is read or refused: nothing
// else.
TEST(BvhCorpus, CutOrChangedAnywhereItIsReadOrRefused) {
  const std::string text = read_text(kCorpus / "plain.bvh");
  auto survive = [](const std::string& bad) {
    try {
      const BvhMotion motion = parse_bvh(bad, "bad.bvh");
      ASSERT_EQ(motion.samples.size(), std::size_t(motion.frames) * motion.channels);
      std::vector<Transform> X;
      const MotionClip clip = clip_from_bvh(motion);
      for (int f = -1; f < motion.frames; ++f) clip_kinematics(clip, f, X);
    } catch (const InputError&) {
    }
  };
  for (size_t n = 0; n < text.size(); ++n) survive(text.substr(0, n));
  std::mt19937 random(1);
  for (size_t n = 0; n < text.size(); ++n)
    for (const char c : {'{', '}', ' ', '\n', '-', '9', 'e', '\xff', char(random())}) {
      std::string bad = text;
      bad[n] = c;
      survive(bad);
    }
}

TEST(BvhLimits, DeepAndWideTreesAreRefusedWithoutRecursion) {
  EXPECT_EQ(parse_bvh(chain(256), "deep.bvh").joints.size(), 256u);
  EXPECT_THROW(parse_bvh(chain(257), "deep.bvh"), InputError);
  EXPECT_THROW(parse_bvh(chain(200000), "deep.bvh"), InputError);
  EXPECT_EQ(parse_bvh(star(65535), "wide.bvh").joints.size(), 65535u);
  EXPECT_THROW(parse_bvh(star(65536), "wide.bvh"), InputError);
}

TEST(BvhLimits, MissingFoldersAndPipesAreRefused) {
  EXPECT_THROW(read_bvh("no/such/file.bvh"), InputError);
  EXPECT_THROW(read_bvh(kCorpus), InputError);
  EXPECT_THROW(read_bvh("/dev/zero"), InputError);
}

TEST(Bvh, GivenRateTakesThePlaceOfABadFrameTime) {
  const BvhMotion motion = read_bvh(kCorpus / "frame_time_zero.bvh", {.fps = 60});
  EXPECT_EQ(motion.fps, 60);
  EXPECT_EQ(motion.frames, 2);
  EXPECT_THROW(read_bvh(kCorpus / "plain.bvh", {.fps = -1}), UsageError);
}

TEST(Bvh, RotationsApplyInTheListedOrderAndPositionsReplaceOffsets) {
  const BvhMotion motion = parse_bvh(kTwoJoints, "two.bvh");
  std::vector<Transform> X;
  const MotionClip clip = clip_from_bvh(motion);
  clip_kinematics(clip, 0, X);
  auto turn = [](double degrees, const Vec3& axis) {
    return Eigen::AngleAxisd(degrees * 3.14159265358979 / 180, axis).toRotationMatrix();
  };
  const Mat3 a = turn(30, Vec3::UnitZ()) * turn(20, Vec3::UnitY()) * turn(10, Vec3::UnitX());
  const Mat3 b = turn(40, Vec3::UnitX()) * turn(50, Vec3::UnitZ()) * turn(60, Vec3::UnitY());
  EXPECT_TRUE(X[0].linear().isApprox(a, 1e-12));
  EXPECT_TRUE(X[0].translation().isApprox(Vec3(5, 6, 7), 1e-12));
  EXPECT_TRUE(X[1].linear().isApprox(a * b, 1e-12));
  EXPECT_TRUE(X[1].translation().isApprox(Vec3(5, 6, 7) + a * Vec3(0, 3, 0), 1e-12));
  clip_kinematics(clip, -1, X);
  EXPECT_TRUE(X[1].translation().isApprox(Vec3(1, 4, 3), 1e-12));
}

TEST(Bvh, WritingAndReadingAgainGivesTheSame) {
  const BvhMotion motion = parse_bvh(kTwoJoints, "two.bvh");
  const BvhMotion again = parse_bvh(format_bvh(motion), "two.bvh");
  ASSERT_EQ(again.joints.size(), motion.joints.size());
  EXPECT_EQ(again.joints[1].name, "b");
  EXPECT_EQ(again.joints[1].channels, motion.joints[1].channels);
  EXPECT_EQ(again.joints[1].end_sites.size(), 1u);
  EXPECT_EQ(again.fps, motion.fps);
  for (size_t k = 0; k < motion.samples.size(); ++k)
    EXPECT_NEAR(again.samples[k], motion.samples[k], 1e-9);
  EXPECT_EQ(format_bvh(again), format_bvh(motion));
}

TEST(Bvh, OurOwnMotionsComeBackFromTheFile) {
  Skeleton skeleton;
  for (const auto& [name, parent] : std::vector<std::pair<std::string, int>>{
           {"pelvis", -1}, {"hip_l", 0}, {"l5", 0}, {"knee_l", 1}, {"l4", 2}}) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.X_PJ.translation() = Vec3(0.1, -0.2 + 0.1 * parent, 0.05);
    skeleton.joints.push_back(joint);
  }
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Motion motion{.fps = 60, .frames = {}};
  for (int f = 0; f < 50; ++f) {
    Pose pose = rest_pose(skeleton);
    pose.root = Vec3(normal(random), normal(random), normal(random));
    for (Quat& q : pose.rotations)
      q = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
    motion.frames.push_back(pose);
  }
  const BvhMotion bvh = parse_bvh(format_bvh(to_bvh(skeleton, motion)), "own.bvh");
  const MotionClip clip = clip_from_bvh(bvh);
  std::vector<Transform> ours, theirs;
  for (int f = 0; f < 50; ++f) {
    forward_kinematics(skeleton, motion.frames[f], ours);
    clip_kinematics(clip, f, theirs);
    for (size_t j = 0; j < bvh.joints.size(); ++j)
      EXPECT_TRUE(theirs[j].isApprox(ours[find_joint(skeleton, bvh.joints[j].name)], 1e-9));
  }
}

TEST(BvhReal, EveryCapturedFileIsRead) {
  const fs::path folder = fs::path(ECORCHE_SHARED_DIR) / "testdata" / "motion";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent";
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".bvh") continue;
    SCOPED_TRACE(entry.path().string());
    const BvhMotion motion = read_bvh(entry.path());
    EXPECT_GT(motion.joints.size(), 1u);
    EXPECT_GT(motion.frames, 0);
    const double nominal = std::round(motion.fps * 1001) / 1001;
    EXPECT_NEAR(motion.fps, nominal, 1e-6) << "not a rational rate";
    std::vector<Transform> X;
    clip_kinematics(clip_from_bvh(motion), motion.frames - 1, X);
    for (const Transform& x : X) EXPECT_TRUE(x.matrix().allFinite());
    ++files;
  }
  EXPECT_GE(files, 20);
}
