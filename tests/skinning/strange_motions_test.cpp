// Motions as other people's programs write them: people who sit or crawl, arms that bear nothing
// outwards, takes without tracks for what stays, binary glTF under other endings.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "anatomy/joint_angles.h"
#include "skinning/motion_files/bvh_motion.h"
#include "skinning/motion_files/bvh_read.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/handedness.h"
#include "skinning/retarget/joint_mapping.h"
#include "skinning/retarget/retarget.h"
#include "tests/skinning/plain_skeleton.h"

namespace ecorche {
namespace {

// Degrees about x, y and z of a joint, applied as BVH's channels Z X Y.
using Turns = std::map<std::string, Vec3>;

// A figure of straight limbs in centimetres that stands with its arms out, and one pose in every
// frame.
class Figure {
 public:
  explicit Figure(Turns turns, const Vec3& root = {0, 95, 0}) : turns_(std::move(turns)) {
    text_ = "HIERARCHY\n";
    open("ROOT", "Hips", {0, 0, 0});
    open("JOINT", "Spine", {0, 20, 0});
    open("JOINT", "Neck", {0, 30, 0});
    open("JOINT", "Head", {0, 10, 0});
    end({0, 20, 0});
    close(2);
    for (const double side : {1.0, -1.0}) {
      const std::string s = side > 0 ? "Left" : "Right";
      open("JOINT", s + "Arm", {18 * side, 25, 0});
      open("JOINT", s + "ForeArm", {28 * side, 0, 0});
      open("JOINT", s + "Hand", {25 * side, 0, 0});
      end({10 * side, 0, 0});
      close(3);
    }
    close(1);
    for (const double side : {1.0, -1.0}) {
      const std::string s = side > 0 ? "Left" : "Right";
      open("JOINT", s + "UpLeg", {9 * side, -5, 0});
      open("JOINT", s + "Leg", {0, -42, 0});
      open("JOINT", s + "Foot", {0, -40, 0});
      open("JOINT", s + "ToeBase", {0, -6, 14});
      end({0, 0, 6});
      close(4);
    }
    close(1);
    constexpr int kFrames = 40;
    text_ += "MOTION\nFrames: " + std::to_string(kFrames) + "\nFrame Time: 0.0333333\n";
    for (int f = 0; f < kFrames; ++f) {
      for (int k = 0; k < 3; ++k) text_ += std::to_string(root[k]) + " ";
      for (const std::string& name : order_) {
        const auto found = turns_.find(name);
        const Vec3 t = found == turns_.end() ? Vec3(Vec3::Zero()) : found->second;
        for (const int k : {2, 0, 1}) text_ += std::to_string(t[k]) + " ";
      }
      text_ += "\n";
    }
  }

  MotionClip clip() const { return clip_from_bvh(parse_bvh(text_, "figure.bvh")); }

 private:
  void offset(const Vec3& at) {
    text_ += "OFFSET";
    for (int k = 0; k < 3; ++k) text_ += " " + std::to_string(at[k]);
    text_ += "\n";
  }
  void open(const std::string& kind, const std::string& name, const Vec3& at) {
    text_ += kind + " " + name + "\n{\n";
    offset(at);
    text_ += kind == "ROOT" ? "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
                            : "CHANNELS 3 Zrotation Xrotation Yrotation\n";
    order_.push_back(name);
  }
  void end(const Vec3& at) {
    text_ += "End Site\n{\n";
    offset(at);
    text_ += "}\n";
  }
  void close(int count) {
    for (int k = 0; k < count; ++k) text_ += "}\n";
  }

  Turns turns_;
  std::string text_;
  std::vector<std::string> order_;
};

RetargetOptions free() {
  RetargetOptions options;
  options.plant_feet = options.ballistic_flights = options.clamp_limits = false;
  return options;
}

}  // namespace

TEST(StrangeMotions, WhoSitsWithHighKneesIsNotMirrored) {
  const Skeleton ours = plain_skeleton();
  for (const double thigh : {-60.0, -90.0, -105.0, -120.0}) {
    SCOPED_TRACE(thigh);
    Turns turns;
    for (const std::string s : {"Left", "Right"})
      turns[s + "UpLeg"] = {thigh, 0, 0}, turns[s + "Leg"] = {100, 0, 0};
    const MotionClip sits = Figure(turns, {0, 50, 0}).clip();
    EXPECT_FALSE(is_mirrored(sits, map_joints(sits, ours, {})));
    const MotionClip other = mirrored(sits);
    EXPECT_TRUE(is_mirrored(other, map_joints(other, ours, {})));
  }
}

TEST(StrangeMotions, WhoCrawlsIsNotStoodUp) {
  const Skeleton ours = plain_skeleton();
  Turns turns = {{"Hips", {85, 0, 0}}};
  for (const std::string s : {"Left", "Right"}) {
    turns[s + "UpLeg"] = {-85, 0, 0};
    turns[s + "Leg"] = {85, 0, 0};
    turns[s + "Foot"] = {80, 0, 0};
  }
  turns["LeftArm"] = {0, -90, 0};
  turns["RightArm"] = {0, 90, 0};
  RetargetReport report;
  // Knees and hands are on the ground.
  const Motion moved = retarget(Figure(turns, {0, 46, 0}).clip(), ours, free(), report);
  EXPECT_EQ(report.up, 'y');
  EXPECT_LT((moved.frames[0].rotations[0] * Vec3::UnitY()).y(), 0.3);
  // A file that stands along another axis than its rest pose still does.
  const Motion stands =
      retarget(Figure({{"Hips", {90, 0, 0}}}, {0, 0, 95}).clip(), ours, free(), report);
  EXPECT_EQ(report.up, 'z');
  EXPECT_GT((stands.frames[0].rotations[0] * Vec3::UnitY()).y(), 0.9);
}

TEST(StrangeMotions, BentForearmsPointWhereTheFilesDo) {
  Skeleton ours = plain_skeleton();
  for (const std::string s : {"_l", "_r"}) {  // a forearm that bears outwards by 12 deg
    Joint& elbow = ours.joints[std::size_t(find_joint(ours, "elbow" + s))];
    elbow.min[1] = elbow.min[2] = -1 * kDegree;
    elbow.max[1] = elbow.max[2] = 1 * kDegree;
    const Vec3 along =
        (rest_positions(ours)[std::size_t(find_joint(ours, "wrist" + s))] -
         rest_positions(ours)[std::size_t(find_joint(ours, "elbow" + s))])
            .normalized();
    const Vec3 aside = along.cross(elbow.axes.col(0)).normalized();
    elbow.axes = Eigen::AngleAxisd(12 * kDegree, aside).toRotationMatrix() * elbow.axes;
  }
  for (const double bend : {60.0, 90.0, 120.0}) {
    SCOPED_TRACE(bend);
    const Turns turns = {{"LeftArm", {0, 0, -50}},
                         {"RightArm", {0, 0, 50}},
                         {"LeftForeArm", {0, -bend, 0}},
                         {"RightForeArm", {0, bend, 0}}};
    const MotionClip clip = Figure(turns).clip();
    RetargetReport report;
    const Motion moved = retarget(clip, ours, free(), report);
    std::vector<Transform> X, source;
    forward_kinematics(ours, moved.frames[0], X);
    clip_kinematics(clip, 0, source);
    const auto place = [&](const std::string& name) {
      for (std::size_t j = 0; j < clip.joints.size(); ++j)
        if (clip.joints[j].name == name) return Vec3(source[j].translation());
      return Vec3(Vec3::Zero());
    };
    for (const auto& [s, side] : {std::pair{"_l", "Left"}, {"_r", "Right"}}) {
      const std::string name = side;
      const Vec3 wanted = (place(name + "Hand") - place(name + "ForeArm")).normalized();
      const std::size_t elbow = std::size_t(find_joint(ours, std::string("elbow") + s)),
                        wrist = std::size_t(find_joint(ours, std::string("wrist") + s));
      const Vec3 got = (X[wrist].translation() - X[elbow].translation()).normalized();
      EXPECT_LT(std::acos(std::min(1.0, got.dot(wanted))), 3 * kDegree);
    }
  }
}

TEST(StrangeMotions, JointsWithoutTracksAreReadFromAnyBinaryGltf) {
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)"
      R"({"name":"Hips","children":[1,3],"translation":[0,0.9,0]},)"
      R"({"name":"Spine","children":[2],"translation":[0,0.2,0]},)"
      R"({"name":"Head","translation":[0,0.5,0]},{"name":"Cape","mesh":0}],)"
      R"("meshes":[{"primitives":[]}],)"
      R"("buffers":[{"byteLength":40,"uri":"data:application/octet-stream;base64,)"
      R"(AAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPw=="}],)"
      R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":8},)"
      R"({"buffer":0,"byteOffset":8,"byteLength":32}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":2,"type":"SCALAR"},)"
      R"({"bufferView":1,"componentType":5126,"count":2,"type":"VEC4"}],)"
      R"("animations":[{"samplers":[{"input":0,"output":1}],)"
      R"("channels":[{"sampler":0,"target":{"node":0,"path":"rotation"}}]}]})";
  while (json.size() % 4 != 0) json += ' ';
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / "ecorche_strange_motion.vrma";
  {
    std::ofstream out(file, std::ios::binary);
    const auto word = [&](std::uint32_t value) {
      char bytes[4];
      std::memcpy(bytes, &value, 4);
      out.write(bytes, 4);
    };
    out << "glTF";
    word(2), word(std::uint32_t(20 + json.size())), word(std::uint32_t(json.size()));
    out << "JSON" << json;
  }
  const MotionClip clip = read_motion(file, {});
  std::filesystem::remove(file);
  std::vector<std::string> names;
  for (const ClipJoint& joint : clip.joints) names.push_back(joint.name);
  EXPECT_EQ(names, std::vector<std::string>({"Hips", "Spine", "Head"}));
}

}  // namespace ecorche
