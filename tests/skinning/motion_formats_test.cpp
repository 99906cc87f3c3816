// Laws of motion files: what each format means, one take in several formats comes out alike, parts
// of a motion, and faults that are told.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/joint_angles.h"
#include "skinning/motion_files/acclaim_read.h"
#include "skinning/motion_files/bvh_write.h"
#include "skinning/motion_files/clip_times.h"
#include "skinning/motion_files/deepmimic_read.h"
#include "skinning/motion_files/fbx_write.h"
#include "skinning/motion_files/opensim_read.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/motion_files/skeleton_beside.h"
#include "skinning/retarget/lost_frames.h"
#include "skinning/retarget/recording_faults.h"
#include "skinning/retarget/retarget.h"
#include "tests/skinning/plain_skeleton.h"

using namespace ecorche;
namespace fs = std::filesystem;

namespace {

const fs::path kTakes = fs::path(ECORCHE_SHARED_DIR) / "testdata" / "motion";
const fs::path kFormats = fs::path(ECORCHE_TEST_DIR) / "corpus" / "motion";
const fs::path kOurWalk = fs::path(ECORCHE_TEST_DIR) / ".." / "data" / "motions" / "walk.bvh";

// The root, an arm that lies along x and bends in a frame turned by 90 degrees about z.
std::string small_asf(const char* angle, double quarter, const char* dof = "rx ry rz") {
  return fmt::format(
      "# a remark\n:version 1.10\n:units\n mass 1.0\n length 0.45\n angle {}\n:root\n order TX TY "
      "TZ RX RY RZ\n axis XYZ\n position 0 0 0\n orientation 0 0 0\n:bonedata\n begin\n  id 1\n  "
      "name upper\n  direction 1 0 0\n  length 2\n  axis 0 0 {} XYZ\n  dof {}\n  limits (-1 1)\n"
      " (-1 1)\n (-1 1)\n end\n begin\n  name lower\n  direction 1 0 0\n  length 3\n  axis 0 0 0 "
      "XYZ\n  dof rz\n end\n:hierarchy\n begin\n  root upper\n  upper lower\n end\n",
      angle, quarter, dof);
}

std::vector<Vec3> places(const MotionClip& clip, int frame) {
  std::vector<Transform> X;
  clip_kinematics(clip, frame, X);
  std::vector<Vec3> out;
  for (const Transform& one : X) out.push_back(one.translation());
  return out;
}

// Where the last joint's bone ends.
Vec3 last_end(const MotionClip& clip, int frame) {
  std::vector<Transform> X;
  clip_kinematics(clip, frame, X);
  return X.back() * clip.joints.back().end_sites.at(0);
}

RetargetOptions unplanted() {
  RetargetOptions options;
  options.plant_feet = options.ballistic_flights = false;
  options.clamp_limits = false;
  return options;
}

const std::vector<std::string>& compared_joints() {
  static const std::vector<std::string> names = {
      "pelvis",  "thorax",     "head",       "hip_l",   "hip_r",   "knee_l",  "knee_r", "ankle_l",
      "ankle_r", "shoulder_l", "shoulder_r", "elbow_l", "elbow_r", "wrist_l", "wrist_r"};
  return names;
}

// Places of compared_joints() by frame, in our axes, and directions of limbs.
struct Centres {
  std::vector<std::vector<Vec3>> frames;
  double fps = 0;
};

Centres joint_centres(const MotionClip& clip) {
  const Skeleton skeleton = plain_skeleton();
  RetargetReport report;
  const Motion motion = retarget(clip, skeleton, unplanted(), report);
  Centres out{{}, motion.fps};
  std::vector<Transform> X;
  for (const Pose& pose : motion.frames) {
    forward_kinematics(skeleton, pose, X);
    out.frames.emplace_back();
    for (const std::string& name : compared_joints())
      out.frames.back().push_back(X[std::size_t(find_joint(skeleton, name))].translation());
  }
  return out;
}

// The file's own figure, y up.
Centres file_centres(const MotionClip& clip) {
  const JointMapping mapping = map_joints(clip, plain_skeleton(), {});
  Centres out{{}, clip.fps};
  std::vector<Transform> X;
  for (int f = 0; f < clip.frame_count; ++f) {
    clip_kinematics(clip, f, X);
    out.frames.emplace_back();
    for (const std::string& name : compared_joints())
      out.frames.back().push_back(X[std::size_t(mapping.position_joint.at(name))].translation());
  }
  return out;
}

// At a time before the end: a marker pose may stand at the beginning of either file.
std::vector<Vec3> row_before_end(const Centres& c, double seconds) {
  const double at = double(c.frames.size() - 1) - seconds * c.fps;
  const std::size_t low = std::size_t(std::max(0.0, std::floor(at + 1e-6))),
                    high = std::min(low + 1, c.frames.size() - 1);
  std::vector<Vec3> out;
  for (std::size_t j = 0; j < c.frames[low].size(); ++j)
    out.push_back(c.frames[low][j] +
                  std::max(0.0, at - double(low)) * (c.frames[high][j] - c.frames[low][j]));
  return out;
}

struct Difference {
  double mean = 0, worst = 0;  // m, between joint centres
  double limbs = 0;            // rad, mean between directions of limbs
  double turned = 0;           // rad about y, constant
  Vec3 moved = Vec3::Zero();   // m, constant
  std::map<std::string, double> by_joint;
};

// After one turn about y and one shift of the whole take, which files may choose as they like.
Difference difference(const Centres& a, const Centres& b) {
  const double fps = std::min(a.fps, b.fps);
  // The first tenth of a second is left to marker poses.
  const int count = int(
      (std::min(double(a.frames.size() - 1) / a.fps, double(b.frames.size() - 1) / b.fps) - 0.1) *
      fps);
  const std::size_t joints = compared_joints().size();
  std::vector<Vec3> ours, theirs;
  Vec3 middle_a = Vec3::Zero(), middle_b = Vec3::Zero();
  for (int f = 0; f < count; ++f) {
    const std::vector<Vec3> p = row_before_end(a, f / fps), q = row_before_end(b, f / fps);
    ours.insert(ours.end(), p.begin(), p.end());
    theirs.insert(theirs.end(), q.begin(), q.end());
  }
  for (std::size_t i = 0; i < ours.size(); ++i) middle_a += ours[i], middle_b += theirs[i];
  middle_a /= double(ours.size()), middle_b /= double(ours.size());
  double sine = 0, cosine = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const Vec3 p = ours[i] - middle_a, q = theirs[i] - middle_b;
    cosine += p.x() * q.x() + p.z() * q.z();
    sine += q.z() * p.x() - q.x() * p.z();
  }
  Difference out;
  out.turned = std::atan2(sine, cosine);
  const Mat3 R = Eigen::AngleAxisd(out.turned, Vec3::UnitY()).toRotationMatrix();
  out.moved = middle_a - R * middle_b;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const double off = (ours[i] - R * theirs[i] - out.moved).norm();
    out.mean += off / double(ours.size());
    out.worst = std::max(out.worst, off);
    out.by_joint[compared_joints()[i % joints]] += off / count;
  }
  for (const auto& [from, to] :
       {std::pair{3, 5}, {4, 6}, {5, 7}, {6, 8}, {9, 11}, {10, 12}, {11, 13}, {12, 14}})
    for (int f = 0; f < count; ++f) {
      const std::size_t row = std::size_t(f) * joints;
      const Vec3 p = ours[row + std::size_t(to)] - ours[row + std::size_t(from)],
                 q = R * (theirs[row + std::size_t(to)] - theirs[row + std::size_t(from)]);
      out.limbs += std::atan2(p.cross(q).norm(), p.dot(q)) / (8.0 * count);
    }
  return out;
}

std::string in_words(const Difference& d) {
  std::string out = fmt::format(
      "mean {:.1f} mm, worst {:.1f} mm, limbs {:.2f} deg, turned {:.2f} deg, moved {:.0f} {:.0f} "
      "{:.0f} mm;",
      1e3 * d.mean, 1e3 * d.worst, d.limbs / kDegree, d.turned / kDegree, 1e3 * d.moved.x(),
      1e3 * d.moved.y(), 1e3 * d.moved.z());
  for (const auto& [name, off] : d.by_joint) out += fmt::format(" {} {:.0f}", name, 1e3 * off);
  return out;
}

// The walk that is in the repository, as a clip that may be spoilt.
MotionClip our_walk() { return read_motion(kOurWalk); }

std::vector<RecordingFault> faults_of(const MotionClip& clip) {
  RetargetReport report;
  retarget(clip, plain_skeleton(), unplanted(), report);
  return report.faults;
}

int count_of(const std::vector<RecordingFault>& faults, RecordingFault::Kind kind) {
  return int(std::ranges::count_if(faults, [&](const auto& f) { return f.kind == kind; }));
}

// Joints, frames, rate and warnings of what a corpus file holds.
std::string outcome_of(const std::string& file) {
  const std::string text = read_input_file(kFormats / file);
  const fs::path ending = fs::path(file).extension();
  if (ending == ".asf") return fmt::format("skeleton {}", parse_asf(text, file).bones.size());
  if (file.starts_with("character_"))
    return fmt::format("skeleton {}", parse_deepmimic_character(text, file).joints.size());
  MotionClip clip;
  if (ending == ".npz")
    clip = read_motion(kFormats / file);
  else if (ending == ".amc")
    clip = parse_amc(text, file, parse_asf(read_input_file(kFormats / "arm.asf"), "arm.asf"), {});
  else if (ending == ".txt")
    clip = parse_deepmimic(
        text, file,
        parse_deepmimic_character(read_input_file(kFormats / "character_arm.txt"), "arm"), {});
  else
    clip = clip_from_coordinates(parse_coordinates(text, file), {});
  EXPECT_EQ(clip.rotations.size(), std::size_t(clip.frame_count) * clip.rotation_tracks);
  EXPECT_EQ(clip.translations.size(), std::size_t(clip.frame_count) * clip.translation_tracks);
  return fmt::format("ok {} {} {:g} {}", clip.joints.size(), clip.frame_count, clip.fps,
                     clip.warnings.size());
}

}  // namespace

TEST(MotionFormats, EveryFileOfTheCorpusHasItsStatedOutcome) {
  std::ifstream stream(kFormats / "expected.txt");
  int files = 0;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::size_t bar = line.find(" | ");
    const std::string file = line.substr(0, bar), expected = line.substr(bar + 3);
    SCOPED_TRACE(line);
    ++files;
    if (!expected.starts_with("error ")) {
      EXPECT_EQ(outcome_of(file), expected);
      continue;
    }
    try {
      ADD_FAILURE() << "was accepted: " << outcome_of(file);
    } catch (const Error& e) {
      const std::string message = e.what();
      EXPECT_NE(message.find(expected.substr(6)), std::string::npos) << message;
      EXPECT_TRUE(message.starts_with(file) || file == "empty.asf") << message;
    }
  }
  EXPECT_GT(files, 95);
  const std::string deep = "{\"Frames\":" + std::string(1000000, '[');
  EXPECT_TRUE(is_deepmimic(deep));
  EXPECT_THROW(parse_deepmimic(deep, "deep.txt", {}, {}), InputError);
}

// What is written is read by the program that reads everybody's files.
TEST(Fbx, AMotionComesBackAsItWas) {
  const Skeleton body = plain_skeleton();
  RetargetReport report;
  Motion motion = retarget(read_motion(kOurWalk), body, unplanted(), report);
  motion.frames.resize(40);
  const fs::path file = fs::path(testing::TempDir()) / "walk-written.fbx";
  std::ofstream(file, std::ios::binary) << format_fbx(to_bvh(body, motion), "walk");
  const MotionClip clip = read_motion(file);
  fs::remove(file);
  EXPECT_NEAR(clip.fps, motion.fps, 0.01);
  ASSERT_EQ(clip.frame_count, 40);
  std::map<std::string, std::size_t> joints;
  for (std::size_t j = 0; j < clip.joints.size(); ++j) joints[clip.joints[j].name] = j;
  std::vector<Transform> X, ours;
  for (const int f : {0, 17, 39}) {
    clip_kinematics(clip, f, X);
    forward_kinematics(body, motion.frames[std::size_t(f)], ours);
    const Vec3 root = X[joints.at("pelvis")].translation();
    const double unit =
        (X[joints.at("head")].translation() - root).norm() /
        (ours[std::size_t(find_joint(body, "head"))].translation() - ours[0].translation()).norm();
    EXPECT_TRUE(std::abs(unit - 1) < 1e-4 || std::abs(unit - 100) < 1e-2) << unit;
    for (std::size_t j = 0; j < ours.size(); ++j)
      EXPECT_LT(
          (X[joints.at(body.joints[j].name)].translation() / unit - ours[j].translation()).norm(),
          1e-3)
          << body.joints[j].name;
  }
}

// The files' figures kneel a little more each frame, z is up, arms turned down from straight out.
TEST(ArraysOfRotations, MoveOurBodyAsTheySay) {
  const Skeleton body = plain_skeleton();
  const Joint& knee = body.joints[std::size_t(find_joint(body, "knee_l"))];
  for (const char* file : {"body.npz", "stored.npz", "fingers.npz"}) {
    SCOPED_TRACE(file);
    RetargetReport report;
    const Motion motion = retarget(read_motion(kFormats / file), body, unplanted(), report);
    ASSERT_EQ(motion.frames.size(), 4u);
    EXPECT_EQ(report.up, 'z');
    const auto flexion = [&](int f) {
      return joint_angles(
          knee,
          motion.frames[std::size_t(f)].rotations[std::size_t(find_joint(body, "knee_l"))])[0];
    };
    for (int f = 1; f < 4; ++f) EXPECT_NEAR(flexion(f) - flexion(f - 1), 0.1, 0.01);
    std::vector<Transform> X;
    forward_kinematics(body, motion.frames[0], X);
    const auto at = [&](const char* name) {
      return Vec3(X[std::size_t(find_joint(body, name))].translation());
    };
    // 1.2 rad below the level.
    EXPECT_NEAR((at("elbow_l") - at("shoulder_l")).normalized().y(), -std::sin(1.2), 0.03);
    EXPECT_GT(at("head").y(), at("pelvis").y() + 0.4);
    EXPECT_GT(at("elbow_l").x(), at("elbow_r").x());
    // 1 cm a frame towards -y, which lies in front, in a figure as large as ours.
    EXPECT_NEAR((motion.frames[3].root - motion.frames[0].root).z(), 0.03 * report.scale, 0.002);
  }
}

TEST(Acclaim, RotationsAreAboutFixedAxesOfTheBonesFrame) {
  const AcclaimSkeleton skeleton = parse_asf(small_asf("deg", 90), "a.asf");
  ASSERT_EQ(skeleton.bones.size(), 3u);
  // About the bone's own x, which points along the world's y: the arm turns from x to -z.
  const auto end_of = [&](const std::string& row) {
    return last_end(parse_amc(":DEGREES\n1\nroot 0 0 0 0 0 0\n" + row, "a.amc", skeleton, {}), 0);
  };
  EXPECT_LT((end_of("upper 90 0 0\nlower 0\n") - Vec3(0, 0, -5)).norm(), 1e-12);
  // x before z: -z first, which a turn about the frame's z (the world's) leaves.
  EXPECT_LT((end_of("upper 90 0 90\nlower 0\n") - Vec3(0, 0, -5)).norm(), 1e-12);
  EXPECT_LT((end_of("upper 0 0 0\nlower 90\n") - Vec3(2, 3, 0)).norm(), 1e-12);
  // z before x: first to y, which the turn about it leaves.
  const AcclaimSkeleton other = parse_asf(small_asf("deg", 90, "rz rx ry"), "a.asf");
  const MotionClip clip =
      parse_amc(":DEGREES\n1\nroot 0 0 0 0 0 0\nupper 90 90 0\nlower 0\n", "a.amc", other, {});
  EXPECT_LT((last_end(clip, 0) - Vec3(0, 5, 0)).norm(), 1e-12);
}

TEST(Acclaim, RadiansAreDegreesAndTheRootGoesWhereItIsPut) {
  const double quarter = 90 * kDegree;
  const MotionClip degrees =
      parse_amc(":FULLY-SPECIFIED\n:DEGREES\n1\nroot 1 2 3 0 90 0\nupper 10 20 30\nlower 40\n",
                "a.amc", parse_asf(small_asf("deg", 90), "a.asf"), {});
  const MotionClip radians = parse_amc(
      fmt::format(":FULLY-SPECIFIED\n:RADIANS\n1\nroot 1 2 3 0 {} 0\nupper {} {} {}\nlower {}\n",
                  quarter, 10 * kDegree, 20 * kDegree, 30 * kDegree, 40 * kDegree),
      "a.amc", parse_asf(small_asf("rad", quarter), "a.asf"), {});
  for (std::size_t j = 0; j < 3; ++j)
    EXPECT_LT((places(degrees, 0)[j] - places(radians, 0)[j]).norm(), 1e-12);
  EXPECT_LT((places(degrees, 0)[0] - Vec3(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((places(degrees, 0)[2] - places(degrees, 0)[1]).norm() - 2, 1e-12);
  EXPECT_NEAR(degrees.metres_per_unit.value(), 0.0254 / 0.45, 1e-12);
  EXPECT_EQ(degrees.fps, 120);
  EXPECT_EQ(degrees.warnings.size(), 1u);  // the rate is taken
}

TEST(Acclaim, WhatAFrameLeavesOutStaysUnlessAllIsSpecified) {
  const AcclaimSkeleton skeleton = parse_asf(small_asf("deg", 90), "a.asf");
  const std::string frames =
      "1\nroot 0 0 0 0 0 0\nupper 0 0 0\nlower 90\n2\nroot 1 0 0 0 0 0\nupper 0 0 0\n";
  const MotionClip clip = parse_amc(":DEGREES\n" + frames, "a.amc", skeleton, 60.0);
  EXPECT_LT((last_end(clip, 1) - Vec3(3, 3, 0)).norm(), 1e-12);
  EXPECT_EQ(clip.fps, 60);
  EXPECT_THROW(parse_amc(":FULLY-SPECIFIED\n:DEGREES\n" + frames, "a.amc", skeleton, {}),
               InputError);
}

TEST(Acclaim, TheSkeletonLiesBesideTheMotion) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("skeletons_{}", ::getpid());
  fs::create_directories(folder);
  const auto put = [&](const char* name) { std::ofstream(folder / name) << small_asf("deg", 90); };
  const SkeletonNames names{"a skeleton (.asf)", "", {".asf"}};
  const auto beside = [&](const char* name) {
    return skeleton_beside(folder / name, names).filename().string();
  };
  EXPECT_THROW(beside("02_01.amc"), InputError);
  put("other.ASF");
  EXPECT_EQ(beside("02_01.amc"), "other.ASF");  // the only one
  put("02.asf");
  EXPECT_EQ(beside("02_01.amc"), "02.asf");
  EXPECT_THROW(beside("03_01.amc"), InputError);  // one of two
  put("02_01.asf");
  EXPECT_EQ(beside("02_01.amc"), "02_01.asf");
  fs::remove_all(folder);
}

TEST(DeepMimic, FramesAreQuaternionsAndAnglesInTheCharactersOrder) {
  const DeepMimicCharacter character = parse_deepmimic_character(
      read_input_file(kFormats / "character_arm.txt"), "character_arm.txt");
  ASSERT_EQ(character.joints.size(), 4u);
  const MotionClip clip =
      parse_deepmimic(read_input_file(kFormats / "arm_bends.txt"), "arm_bends.txt", character, {});
  ASSERT_EQ(clip.frame_count, 3);
  EXPECT_EQ(clip.fps, 30);
  // The upper arm hangs; turned by 90 degrees about x it points to -z, bent by 90 about z.
  EXPECT_LT((places(clip, 0)[3] - Vec3(0, 1 - 0.6, 0)).norm(), 1e-6);
  EXPECT_LT((places(clip, 1)[3] - Vec3(0, 1, -0.6)).norm(), 1e-5);
  EXPECT_LT((places(clip, 2)[3] - Vec3(0.3, 1 - 0.3, 0)).norm(), 1e-5);
}

TEST(OpenSimAngles, DegreesAreRadiansAndEitherKneeBendsBackwards) {
  const auto table = [](const char* degrees, double unit, double knee) {
    std::string text = fmt::format(
        "Coordinates\nversion=1\nnRows=2\nnColumns=6\ninDegrees={}\nendheader\ntime\tpelvis_ty\t"
        "hip_flexion_r\thip_flexion_l\tknee_angle_r\tknee_angle_l\n",
        degrees);
    for (const double time : {0.0, 0.01})
      text += fmt::format("{}\t0.95\t{}\t0\t{}\t{}\n", time, 20 * unit, knee * 60 * unit,
                          knee * 5 * unit);
    return clip_from_coordinates(parse_coordinates(text, "a.mot"), {});
  };
  const MotionClip a = table("yes", 1, -1), b = table("no", kDegree, -1), c = table("yes", 1, 1);
  EXPECT_EQ(a.fps, 100);
  EXPECT_TRUE(fmt::format("{}", fmt::join(a.warnings, "\n")).find("arm_flex_l") !=
              std::string::npos)
      << "what is missing is told";
  for (std::size_t j = 0; j < a.joints.size(); ++j) {
    EXPECT_LT((places(a, 0)[j] - places(b, 0)[j]).norm(), 1e-12);
    EXPECT_LT((places(a, 0)[j] - places(c, 0)[j]).norm(), 1e-12);
  }
  const auto at = [&](const char* name) {
    return places(
        a, 0)[std::size_t(std::ranges::find(a.joints, name, &ClipJoint::name) - a.joints.begin())];
  };
  EXPECT_GT(at("tibia_r").x(), at("femur_r").x() + 0.1);               // the thigh goes forward
  EXPECT_LT(at("ankle_r").x(), at("tibia_r").x() - 0.2);               // the shin back
  EXPECT_NEAR(std::min(at("toes_l").y(), at("foot_l").y()), 0, 0.01);  // it stands
  EXPECT_THROW(
      clip_from_coordinates(
          parse_coordinates("inDegrees=no\nendheader\ntime\tground_force_vx\n0\t1\n", "g.mot"), {}),
      UnfitError);
}

TEST(OpenSimAngles, OurKneesBendAsTheTableSays) {
  const fs::path file = kTakes / "opensim_markers" / "gait2392_subject01_walk1_ik.mot";
  if (!fs::exists(file)) GTEST_SKIP() << "the recordings are not beside the repository";
  const CoordinateTable table = parse_coordinates(read_input_file(file), "walk.mot");
  const Centres ours = joint_centres(clip_from_coordinates(table, {}));
  ASSERT_EQ(ours.frames.size(), table.rows.size());
  for (const auto& [column, hip] : {std::pair{"knee_angle_l", 3}, {"knee_angle_r", 4}}) {
    const std::size_t c =
        std::size_t(std::ranges::find(table.columns, column) - table.columns.begin());
    double off = 0, range = 0;
    for (std::size_t f = 0; f < ours.frames.size(); ++f) {
      const std::vector<Vec3>& at = ours.frames[f];
      const Vec3 thigh = at[std::size_t(hip + 2)] - at[std::size_t(hip)],
                 shin = at[std::size_t(hip + 4)] - at[std::size_t(hip + 2)];
      const double bend = std::atan2(thigh.cross(shin).norm(), thigh.dot(shin)) / kDegree;
      off += std::abs(bend + table.rows[f][c]) / double(ours.frames.size());
      range = std::max(range, bend);
    }
    EXPECT_LT(off, 2.5) << column;
    EXPECT_GT(range, 50) << column;
  }
}

TEST(MotionParts, AreTheFramesOfTheWhole) {
  const MotionClip whole = our_walk();
  MotionClip part = whole;
  cut_clip({read_moment("11f", "--from"), read_moment("20f", "--to")}, part);
  ASSERT_EQ(part.frame_count, 10);
  for (int f = 0; f < 10; ++f) EXPECT_EQ(places(part, f), places(whole, f + 10));
  MotionClip timed = whole;
  cut_clip({read_moment(fmt::format("{}", 10 / whole.fps), "--from"),
            read_moment(fmt::format("{}ms", 19e3 / whole.fps), "--to")},
           timed);
  EXPECT_EQ(timed.frame_count, 10);
  EXPECT_EQ(places(timed, 0), places(part, 0));
  for (const char* wrong : {"", "f", "0f", "1.5f", "-1", "nan", "1h", "s", "1 s", "1e400"})
    EXPECT_THROW(read_moment(wrong, "--from"), UsageError) << wrong;
  const auto cut = [&](const char* from, const char* to) {
    MotionClip clip = whole;
    cut_clip({read_moment(from, "--from"), read_moment(to, "--to")}, clip);
  };
  EXPECT_THROW(cut("5f", "4f"), UsageError);
  EXPECT_THROW(cut("1f", "100000f"), UsageError);
  EXPECT_THROW(cut("1000s", "1001s"), UsageError);
}

TEST(MotionParts, UnevenTimesAreMadeEven) {
  MotionClip clip;
  clip.name = "uneven";
  clip.joints = {{"a", -1, Vec3::Zero(), 0, 0, {}}};
  clip.rotation_tracks = clip.translation_tracks = 1;
  std::vector<double> times;
  for (int f = 0; f < 60; ++f) {
    times.push_back(f / 50.0 + (f % 10 == 5 ? 0.006 : 0));
    clip.rotations.push_back(
        Eigen::AngleAxisd(0.5 * times.back(), Vec3::UnitY()).toRotationMatrix());
    clip.translations.emplace_back(times.back(), 0, 0);
  }
  clip.frame_count = 60;
  MotionClip even = clip;
  set_times(times, even);
  EXPECT_EQ(even.fps, 50);
  ASSERT_GE(even.frame_count, 59);
  for (int f = 0; f < even.frame_count; ++f) {
    EXPECT_NEAR(even.translations[std::size_t(f)].x(), f / 50.0, 1e-9);
    EXPECT_NEAR(Quat(even.rotations[std::size_t(f)])
                    .angularDistance(Quat(Eigen::AngleAxisd(0.01 * f, Vec3::UnitY()))),
                0, 1e-7);
  }
  EXPECT_EQ(even.warnings.size(), 1u);
}

TEST(RecordingFaults, AreFoundWhereTheyAreAndNowhereElse) {
  const MotionClip good = our_walk();
  ASSERT_TRUE(faults_of(good).empty());
  const auto row = [](MotionClip& clip, int frame) {
    return clip.rotations.begin() + std::ptrdiff_t(frame) * clip.rotation_tracks;
  };
  MotionClip still = good;
  const int length = int(0.15 * still.fps) + 3;
  for (int f = 21; f < 20 + length; ++f) {
    std::copy_n(row(still, 20), still.rotation_tracks, row(still, f));
    std::copy_n(still.translations.begin() + 20L * still.translation_tracks,
                still.translation_tracks,
                still.translations.begin() + std::ptrdiff_t(f) * still.translation_tracks);
  }
  const auto found = faults_of(still);
  ASSERT_EQ(count_of(found, RecordingFault::Kind::still), 1);
  const auto run = std::ranges::find(found, RecordingFault::Kind::still, &RecordingFault::kind);
  EXPECT_EQ(run->first, 20);
  EXPECT_EQ(run->last, 20 + length - 1);

  MotionClip empty = good;
  for (int f = 30; f < 33; ++f) std::fill_n(row(empty, f), empty.rotation_tracks, Mat3::Identity());
  const auto gaps = faults_of(empty);
  ASSERT_EQ(count_of(gaps, RecordingFault::Kind::empty), 1);
  const auto gap = std::ranges::find(gaps, RecordingFault::Kind::empty, &RecordingFault::kind);
  EXPECT_EQ(gap->first, 30);
  EXPECT_EQ(gap->last, 32);

  MotionClip spiked = good;
  const auto knee = std::ranges::find(spiked.joints, "LeftLeg", &ClipJoint::name);
  ASSERT_NE(knee, spiked.joints.end());
  Mat3& turn = *(row(spiked, 40) + knee->rotation_track);
  turn = turn * Eigen::AngleAxisd(120 * kDegree, Vec3::UnitX()).toRotationMatrix();
  const auto spikes = faults_of(spiked);
  ASSERT_EQ(count_of(spikes, RecordingFault::Kind::spike), 2);  // there and back
  EXPECT_EQ(spikes[0].last, 40);
  EXPECT_EQ(spikes[0].joint, "knee_l");
  EXPECT_EQ(spikes[1].first, 40);
}

TEST(RecordingFaults, LostAndRepeatedFramesAreTold) {
  const MotionClip good = our_walk();
  const Skeleton ours = plain_skeleton();
  const JointMapping mapping = map_joints(good, ours, {});
  const auto steps_of = [&](const MotionClip& clip) { return find_uneven_steps(clip, mapping); };
  ASSERT_TRUE(steps_of(good).empty());
  const auto put = [](MotionClip& clip, int frame, const MotionClip& from, int row) {
    std::copy_n(from.rotations.begin() + std::ptrdiff_t(row) * from.rotation_tracks,
                from.rotation_tracks,
                clip.rotations.begin() + std::ptrdiff_t(frame) * clip.rotation_tracks);
    std::copy_n(from.translations.begin() + std::ptrdiff_t(row) * from.translation_tracks,
                from.translation_tracks,
                clip.translations.begin() + std::ptrdiff_t(frame) * clip.translation_tracks);
  };
  MotionClip lacks = good;  // every twentieth
  lacks.frame_count = 0;
  std::vector<int> expected;
  for (int f = 0; f < good.frame_count; ++f) {
    if (f % 20 == 19)
      expected.push_back(lacks.frame_count);
    else
      put(lacks, lacks.frame_count++, good, f);
  }
  if (expected.back() + 1 >= lacks.frame_count) expected.pop_back();
  std::vector<int> found;
  for (const UnevenStep& one : steps_of(lacks)) {
    EXPECT_EQ(one.lost, 1) << one.frame;
    EXPECT_FALSE(one.joint.empty());
    found.push_back(one.frame);
  }
  // Where most joints turn back, a longer step is not seen.
  EXPECT_GE(found.size(), expected.size() * 4 / 5);
  for (const int frame : found) EXPECT_TRUE(std::ranges::count(expected, frame)) << frame;
  const auto lines = describe_uneven_steps("walk.bvh", steps_of(lacks));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("20f, 39f, 58f"), std::string::npos) << lines[0];

  MotionClip again = good;
  put(again, 40, good, 39);
  const auto repeated = steps_of(again);
  ASSERT_EQ(repeated.size(), 1u);  // that the next step goes twice as far follows from it
  EXPECT_EQ(repeated[0].frame, 40);
  EXPECT_EQ(repeated[0].lost, 0);
  RetargetReport report;
  retarget(again, ours, unplanted(), report);
  EXPECT_TRUE(std::ranges::any_of(report.warnings, [](const std::string& line) {
    return line.find("once more: 41f") != std::string::npos;
  }));
}

// Files that hold the same joint centres give the same; a conversion onto a figure whose bones
// point elsewhere at rest (the Daz-friendly files copy rotations onto bent forearms) differs by
// what it differs in itself.
TEST(MotionFormats, OneTakeInSeveralFormatsComesOutAlike) {
  if (!fs::exists(kTakes)) GTEST_SKIP() << "the recordings are not beside the repository";
  struct Pair {
    const char *a, *b;
    std::optional<double> mean;  // m; nothing where the files' own figures differ
  };
  // Of template.fbx the first frame of the walk is all the rest pose that there is, and its lean
  // counts as upright.
  for (const Pair& pair :
       {Pair{"cmu_asf_amc/02_01.amc", "cmu_cgspeed31/02_01_walk.bvh", 0.010},
        Pair{"cmu_fbx/01_01_cmu.fbx", "cmu_cgspeed31/01_01_forward_jumps.bvh", 0.010},
        Pair{"bvhtoolbox/template.fbx", "bvhtoolbox/walk01.bvh", 0.020},
        Pair{"cmu_asf_amc/02_01.amc", "cmu_daz43/02_01.bvh", {}},
        Pair{"cmu_daz43/02_01.bvh", "cmu_cgspeed31/02_01_walk.bvh", {}},
        Pair{"cmu_asf_amc/02_03.amc", "cmu_daz43/02_03.bvh", {}},
        Pair{"cmu_asf_amc/02_04.amc", "cmu_daz43/02_04.bvh", {}}}) {
    MotionClip a, b;
    try {
      a = read_motion(kTakes / pair.a), b = read_motion(kTakes / pair.b);
    } catch (const UnfitError& e) {
      std::cout << "skipped: " << e.what() << "\n";  // ecorche-import is not built
      continue;
    }
    const Difference ours = difference(joint_centres(a), joint_centres(b)),
                     files = difference(file_centres(a), file_centres(b));
    const std::string words =
        fmt::format("{} and {}: {}; the files' own limbs differ by {:.2f} deg", pair.a, pair.b,
                    in_words(ours), files.limbs / kDegree);
    EXPECT_LT(ours.limbs, files.limbs + 0.5 * kDegree) << words;
    if (pair.mean) {
      EXPECT_LT(files.limbs, 1 * kDegree) << words;
      EXPECT_LT(ours.mean, *pair.mean) << words;
    }
  }
}
