// Motions as other people's programs write them: people who sit or crawl, arms that bear nothing
// outwards, takes without tracks for what stays, binary glTF under other endings.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "anatomy/joint_angles.h"
#include "skinning/constraints/ballistic_flight.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/constraints/ground_heights.h"
#include "skinning/constraints/ground_lift.h"
#include "skinning/motion_files/bvh_motion.h"
#include "skinning/motion_files/bvh_read.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/handedness.h"
#include "skinning/retarget/joint_mapping.h"
#include "skinning/retarget/retarget.h"
#include "tests/skinning/plain_legs.h"

namespace ecorche {
namespace {

// Degrees about x, y and z of a joint, applied as BVH's channels Z X Y.
using Turns = std::map<std::string, Vec3>;

struct FigurePose {
  Turns turns;
  Vec3 root = {0, 95, 0};
};

// A figure of straight limbs in centimetres that stands with its arms out at rest.
class Figure {
 public:
  // One pose in every frame.
  explicit Figure(const Turns& turns, const Vec3& root = {0, 95, 0})
      : Figure(30, 40, [&](double) {
          return FigurePose{turns, root};
        }) {}

  // `pose`: by time, s.
  Figure(double fps, int frames, const std::function<FigurePose(double)>& pose) {
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
    text_ += "MOTION\nFrames: " + std::to_string(frames) +
             "\nFrame Time: " + fmt::format("{:.9f}", 1 / fps) + "\n";
    for (int f = 0; f < frames; ++f) {
      const FigurePose now = pose(f / fps);
      for (int k = 0; k < 3; ++k) text_ += fmt::format("{:.6f} ", now.root[k]);
      for (const std::string& name : order_) {
        const auto found = now.turns.find(name);
        const Vec3 t = found == now.turns.end() ? Vec3(Vec3::Zero()) : found->second;
        for (const int k : {2, 0, 1}) text_ += fmt::format("{:.6f} ", t[k]);
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
    const std::string places = kind == "ROOT" ? "6 Xposition Yposition Zposition" : "3";
    text_ += "CHANNELS " + places + " Zrotation Xrotation Yrotation\n";
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

  std::string text_;
  std::vector<std::string> order_;
};

RetargetOptions as_it_is() {
  RetargetOptions options;
  options.plant_feet = options.ballistic_flights = options.clamp_limits = false;
  return options;
}

// A glTF of these nodes whose first has a track of two equal rotations, 1 s apart.
std::string turning_node(const std::string& nodes) {
  return nodes + R"("buffers":[{"byteLength":40,"uri":"data:application/octet-stream;base64,)"
                 R"(AAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPw=="}],)"
                 R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":8},)"
                 R"({"buffer":0,"byteOffset":8,"byteLength":32}],)"
                 R"("accessors":[{"bufferView":0,"componentType":5126,"count":2,"type":"SCALAR"},)"
                 R"({"bufferView":1,"componentType":5126,"count":2,"type":"VEC4"}],)"
                 R"("animations":[{"samplers":[{"input":0,"output":1}],)"
                 R"("channels":[{"sampler":0,"target":{"node":0,"path":"rotation"}}]}]})";
}

MotionClip read_binary_gltf(std::string json) {
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
  MotionClip clip = read_motion(file, {});
  std::filesystem::remove(file);
  return clip;
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
  const Motion moved = retarget(Figure(turns, {0, 46, 0}).clip(), ours, as_it_is(), report);
  EXPECT_EQ(report.up, 'y');
  EXPECT_LT((moved.frames[0].rotations[0] * Vec3::UnitY()).y(), 0.3);
  // A file that stands along another axis than its rest pose still does.
  const Motion stands =
      retarget(Figure({{"Hips", {90, 0, 0}}}, {0, 0, 95}).clip(), ours, as_it_is(), report);
  EXPECT_EQ(report.up, 'z');
  EXPECT_GT((stands.frames[0].rotations[0] * Vec3::UnitY()).y(), 0.9);
}

TEST(StrangeMotions, BentForearmsPointWhereTheFilesDo) {
  Skeleton ours = plain_skeleton();
  for (const std::string s : {"_l", "_r"}) {  // a forearm that bears outwards by 12 deg
    Joint& elbow = ours.joints[std::size_t(find_joint(ours, "elbow" + s))];
    elbow.min[1] = elbow.min[2] = -1 * kDegree;
    elbow.max[1] = elbow.max[2] = 1 * kDegree;
    const Vec3 along = (rest_positions(ours)[std::size_t(find_joint(ours, "wrist" + s))] -
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
    const Motion moved = retarget(clip, ours, as_it_is(), report);
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

// Arms that never bend tell nothing of where their elbows' hinges lie.
TEST(StrangeMotions, StraightArmsDoNotTurnAboutTheirLength) {
  MotionClip clip =
      Figure({{"LeftArm", {20, 10, -70}}, {"RightArm", {0, -15, 60}}, {"Spine", {5, 20, 0}}})
          .clip();
  // It faces a little aside, so that no arm lies along an axis.
  const Mat3 aside = Eigen::AngleAxisd(10 * kDegree, Vec3::UnitY()).toRotationMatrix();
  for (ClipJoint& joint : clip.joints) joint.offset = aside * joint.offset;
  for (Mat3& turn : clip.rotations) turn = aside * turn * aside.transpose();
  for (const std::string s : {"_l", "_r"}) {
    std::optional<Quat> usual;
    for (double hinge = 0; hinge < 360; hinge += 15) {
      SCOPED_TRACE(fmt::format("shoulder{}, hinge at {} deg", s, hinge));
      Skeleton ours = plain_skeleton();
      Joint& elbow = ours.joints[std::size_t(find_joint(ours, "elbow" + s))];
      const std::vector<Vec3> rest = rest_positions(ours);
      const Vec3 along = (rest[std::size_t(find_joint(ours, "wrist" + s))] -
                          rest[std::size_t(find_joint(ours, "elbow" + s))])
                             .normalized();
      elbow.axes = Eigen::AngleAxisd(hinge * kDegree, along).toRotationMatrix() * elbow.axes;
      RetargetReport report;
      const Motion moved = retarget(clip, ours, as_it_is(), report);
      const std::size_t shoulder = std::size_t(find_joint(ours, "shoulder" + s));
      if (!usual) usual = moved.frames[0].rotations[shoulder];
      EXPECT_LT(usual->angularDistance(moved.frames[0].rotations[shoulder]), 1 * kDegree);
    }
  }
}

// Knees go up in turn, the standing leg bends a little, so that feet lift off and land.
FigurePose marching(double t) {
  FigurePose out;
  double lowest = 0;
  for (const double side : {1.0, -1.0}) {
    const std::string s = side > 0 ? "Left" : "Right";
    const double up = std::max(0.0, side * std::sin(2 * 3.14159265 * 1.1 * t + 0.4));
    const double thigh = (12 + 45 * up * up) * kDegree, knee = (24 + 60 * up * up) * kDegree;
    out.turns[s + "UpLeg"] = {-thigh / kDegree, 0, 0};
    out.turns[s + "Leg"] = {knee / kDegree, 0, 0};
    out.turns[s + "Foot"] = {(thigh - knee) / kDegree, 0, 0};
    lowest = std::max(lowest, 5 + 42 * std::cos(thigh) + 40 * std::cos(knee - thigh) + 6);
  }
  out.root = {3 * std::sin(2 * t), lowest, 10 * t};
  return out;
}

TEST(StrangeMotions, TheRateOfTheFramesHardlyMatters) {
  const Skeleton ours = skeleton_with_legs();
  std::map<int, Motion> moved;
  for (const int fps : {24, 60, 240}) {
    RetargetReport report;
    moved[fps] = retarget(Figure(fps, 3 * fps + 1, marching).clip(), ours, {}, report);
    ASSERT_EQ(moved[fps].fps, fps);
    ASSERT_EQ(moved[fps].frames.size(), 3 * fps + 1);
    EXPECT_GE(report.contacts.size(), 6);
    for (const Contact& one : report.contacts) EXPECT_LE(one.end, 3 * fps + 1);
  }
  std::vector<Transform> X, Y;
  for (const int fps : {24, 60})
    for (const char* joint : {"pelvis", "knee_l", "knee_r", "ankle_l", "ankle_r"}) {
      double sum = 0;
      constexpr int kCommon = 36;  // twelfths of a second
      for (int k = 0; k < kCommon; ++k) {
        forward_kinematics(ours, moved[fps].frames[std::size_t(k * fps / 12)], X);
        forward_kinematics(ours, moved[240].frames[std::size_t(k * 20)], Y);
        const std::size_t j = std::size_t(find_joint(ours, joint));
        sum += (X[j].translation() - Y[j].translation()).norm() / kCommon;
      }
      EXPECT_LT(sum, fps == 24 ? 0.7e-3 : 0.25e-3) << fps << " " << joint;
    }
}

TEST(StrangeMotions, JointsWithoutTracksAreReadFromAnyBinaryGltf) {
  const MotionClip clip = read_binary_gltf(
      turning_node(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)"
                   R"({"name":"Hips","children":[1,3],"translation":[0,0.9,0]},)"
                   R"({"name":"Spine","children":[2],"translation":[0,0.2,0]},)"
                   R"({"name":"Head","translation":[0,0.5,0]},{"name":"Cape","mesh":0}],)"
                   R"("meshes":[{"primitives":[]}],)"));
  std::vector<std::string> names;
  for (const ClipJoint& joint : clip.joints) names.push_back(joint.name);
  EXPECT_EQ(names, std::vector<std::string>({"Hips", "Spine", "Head"}));
}

// Stands, then kneels on the tips of its toes.
FigurePose kneeling(double t) {
  const double w = std::clamp((t - 1) / 0.1, 0.0, 1.0), down = w * w * (3 - 2 * w),
               bow = std::sin(3.14159265 * down);
  FigurePose out;
  for (const std::string s : {"Left", "Right"}) {
    out.turns[s + "UpLeg"] = {-40 * bow, 0, 0};
    out.turns[s + "Leg"] = {104.5 * down + 30 * bow, 0, 0};
    out.turns[s + "Foot"] = {-32.5 * down, 0, 0};
  }
  out.root = {0, 93 + (50.5 - 93) * down, 20 * down};
  return out;
}

// How high toes are that a foot stands on depends on its length, and says nothing of the ground.
TEST(StrangeMotions, WhoKneelsLaterStandsAsTallBefore) {
  const Skeleton ours = skeleton_with_legs();
  RetargetReport report;
  const Motion stands = retarget(Figure(60, 20, kneeling).clip(), ours, {}, report),
               kneels = retarget(Figure(60, 361, kneeling).clip(), ours, {}, report);
  EXPECT_EQ(std::ranges::count_if(report.contacts,
                                  [](const Contact& one) { return !one.heel && one.begin > 60; }),
            2);
  EXPECT_NEAR(kneels.frames[10].root.y(), stands.frames[10].root.y(), 2e-3);
}

// A marker pose, arms out, and a figure that sways, whose arms still swing down for a while.
TEST(StrangeMotions, AMarkerPoseTakesNoMoreOfACoarseTake) {
  const auto pose = [](double t) {
    FigurePose out;
    const double sway = 15 * std::sin(3.14159265 * t),
                 hang = t == 0 ? 0 : 80 - 40 * std::exp(-t / 0.08);
    out.turns["LeftUpLeg"] = {-sway, 0, 0};
    out.turns["RightUpLeg"] = {sway, 0, 0};
    out.turns["LeftArm"] = {0, 0, -hang};
    out.turns["RightArm"] = {0, 0, hang};
    return out;
  };
  RetargetReport report;
  retarget(Figure(24, 72, pose).clip(), skeleton_with_legs(), {}, report);
  EXPECT_GE(report.dropped_frames, 1);
  EXPECT_LE(report.dropped_frames, 3);
}

// Two flights that differ by a trifle, about as weak as flights may be, come out alike.
TEST(StrangeMotions, AFlightAtABoundDoesNotLeap) {
  const Skeleton ours = skeleton_with_legs();
  const double sole = guess_sole_height(ours);
  std::vector<double> highest;
  for (double pull = 0.40; pull < 0.60; pull += 0.005) {
    Motion motion{120, {}};
    for (int f = 0; f < 120; ++f) {
      Pose pose;
      pose.rotations.assign(ours.joints.size(), Quat::Identity());
      const double t = std::clamp((f - 40) / 120.0, 0.0, 0.4);
      pose.root = Vec3(0, rest_positions(ours)[0].y() - sole + pull * 9.81 * t * (0.4 - t) / 2, 0);
      motion.frames.push_back(pose);
    }
    make_flights_ballistic(ours, sole, 9.81, motion);
    double most = 0;
    for (const Pose& one : motion.frames) most = std::max(most, one.root.y());
    highest.push_back(most);
  }
  double step = 0;
  for (std::size_t k = 1; k < highest.size(); ++k)
    step = std::max(step, std::abs(highest[k] - highest[k - 1]));
  EXPECT_GT(highest.back() - highest.front(), 0.05);  // the strongest falls, the weakest does not
  EXPECT_LT(step, 0.02);
}

// Points on spheres around knees, wrists, and the fingers' ends of a body whose joints are thick.
GroundPoints round_flesh(const Skeleton& skeleton) {
  const auto ball = [&](const std::string& joint, const Vec3& centre, double radius) {
    GroundPatch out{find_joint(skeleton, joint), {}, centre.norm() + radius};
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          if (x != 0 || y != 0 || z != 0)
            out.points.emplace_back(centre + radius * Vec3(x, y, z).normalized());
    return out;
  };
  GroundPoints out;
  for (std::size_t side = 0; side < 2; ++side) {
    const std::string s = side == 0 ? "_l" : "_r";
    out.body.push_back(ball("knee" + s, Vec3::Zero(), 0.05));
    out.hands[side].push_back(ball("wrist" + s, Vec3::Zero(), 0.025));
    out.fingers[side].push_back(ball("pip3" + s, Vec3(0, -0.02, 0), 0.01));
  }
  return out;
}

// Height of the lowest of these points in any frame, and the furthest step of a joint in a frame.
std::pair<double, double> low_and_step(const Skeleton& skeleton, const GroundPoints& points,
                                       const Motion& motion) {
  double low = HUGE_VAL, step = 0;
  std::vector<Transform> X, before;
  for (const Pose& pose : motion.frames) {
    forward_kinematics(skeleton, pose, X);
    for (const auto* patches :
         {&points.body, &points.hands[0], &points.hands[1], &points.fingers[0], &points.fingers[1]})
      for (const GroundPatch& patch : *patches)
        for (const Vec3& p : patch.points)
          low = std::min(low, (X[std::size_t(patch.joint)] * p).y());
    for (std::size_t j = 0; j < before.size(); ++j)
      step = std::max(step, (X[j].translation() - before[j].translation()).norm());
    before = X;
  }
  return {low, step};
}

// Stands, and within a second comes down on knees and hands, which end as points on the ground.
FigurePose falling(double t) {
  const double w = std::clamp(t - 0.3, 0.0, 1.0), down = w * w * (3 - 2 * w),
               bow = std::sin(3.14159265 * down);
  FigurePose out;
  out.turns["Hips"] = {80 * down, 0, 0};
  for (const double side : {1.0, -1.0}) {
    const std::string s = side > 0 ? "Left" : "Right";
    out.turns[s + "UpLeg"] = {-80 * down - 40 * bow, 0, 0};
    out.turns[s + "Leg"] = {90 * down + 50 * bow, 0, 0};
    out.turns[s + "Foot"] = {-20 * bow, 0, 0};
    out.turns[s + "Arm"] = {0, -80 * down * side, -70 * (1 - down) * side};
  }
  out.root = {0, 95 + (43 - 95) * down, 0};
  return out;
}

TEST(StrangeMotions, KneesAndHandsOfWhoFallsStayOutOfTheGround) {
  const Skeleton ours = skeleton_with_legs();
  const GroundPoints flesh = round_flesh(ours);
  const MotionClip clip = Figure(60, 121, falling).clip();
  RetargetReport report;
  RetargetOptions options;
  const auto [deep, usual] = low_and_step(ours, flesh, retarget(clip, ours, options, report));
  EXPECT_LT(deep, -0.03);
  options.ground = flesh;
  const auto [low, step] = low_and_step(ours, flesh, retarget(clip, ours, options, report));
  EXPECT_GT(low, -0.003);
  EXPECT_LT(low, 0.01);
  EXPECT_LT(step, 1.5 * usual);
}

// Corners of soles and toes, 4.5 cm to either side of the middle of each foot.
GroundPoints broad_soles(const Skeleton& skeleton) {
  GroundPoints out;
  const std::vector<Vec3> rest = rest_positions(skeleton);
  for (std::size_t side = 0; side < 2; ++side) {
    const FootShape foot =
        foot_shape(skeleton, side == 0 ? Side::left : Side::right, guess_sole_height(skeleton));
    const auto strip = [&](int joint, const Vec3& from, const Vec3& to) {
      GroundPatch patch{joint, {}, 0.3};
      for (const Vec3& end : {from, to})
        for (const double aside : {-0.045, 0.045})
          patch.points.push_back(end + Vec3(aside, 0, 0) - rest[std::size_t(joint)]);
      out.feet[side].push_back(patch);
    };
    strip(foot.subtalar, foot.heel, foot.ball);
    strip(foot.mtp[2], foot.ball, foot.tip);
  }
  return out;
}

// Stands, then rises on the balls of its feet, which then lean outwards by so many degrees.
FigurePose on_edges(double t, double lean) {
  const double w = std::clamp((t - 0.5) / 0.5, 0.0, 1.0), up = w * w * (3 - 2 * w);
  const double pitch = 30 * kDegree * up;
  FigurePose out;
  out.turns["LeftFoot"] = {pitch / kDegree, 0, lean * up};
  out.turns["RightFoot"] = {pitch / kDegree, 0, -lean * up};
  out.root = {0, 93 + 6 * (std::cos(pitch) - 1) + 14 * std::sin(pitch), 0};
  return out;
}

TEST(StrangeMotions, EdgesOfSolesStayOutOfTheGround) {
  const Skeleton ours = skeleton_with_legs();
  const GroundPoints soles = broad_soles(ours);
  const auto lowest = [&](const Motion& motion) {
    double low = HUGE_VAL;
    for (const GroundHeights& here : ground_heights(ours, soles, motion))
      low = std::min({low, here.feet[0], here.feet[1]});
    return low;
  };
  for (const double lean : {15.0, 30.0}) {
    SCOPED_TRACE(lean);
    const MotionClip clip = Figure(60, 121, [&](double t) { return on_edges(t, lean); }).clip();
    RetargetReport report;
    RetargetOptions options;
    const Motion before = retarget(clip, ours, options, report);
    EXPECT_LT(lowest(before), lean == 15 ? -0.008 : -0.012);
    options.ground = soles;
    const Motion after = retarget(clip, ours, options, report);
    const double low = lowest(after);
    EXPECT_GT(low, -0.003);
    EXPECT_LT(low, 0.003);
    // Legs bend for it, the figure stays as high but for what the pelvis follows its feet.
    EXPECT_NEAR(after.frames[100].root.y(), before.frames[100].root.y(), 0.004);
  }
}

// What neither leg nor arm has taken out of the ground lifts the figure, its soles' edges, too.
TEST(StrangeMotions, ASunkenEdgeOfASoleLiftsTheFigure) {
  const Skeleton ours = skeleton_with_legs();
  const double sole = guess_sole_height(ours);
  Motion motion{60, std::vector<Pose>(30)};
  for (Pose& pose : motion.frames) {
    pose.rotations.assign(ours.joints.size(), Quat::Identity());
    pose.root = rest_positions(ours)[0] + Vec3(0, 0.001 - sole, 0);
  }
  std::vector<GroundHeights> heights(30);
  heights[15].feet = {0.01, -0.02};
  EXPECT_NEAR(lift_from_ground(ours, sole, heights, motion), 0.02, 1e-9);
  EXPECT_NEAR(motion.frames[15].root.y() - motion.frames[0].root.y(), 0.02, 1e-9);
}

// A skin may say of its joints where they are bound, or nothing: then they stand as they are.
TEST(StrangeMotions, JointsOfASkinWithoutBindingsStandAsTheyAre) {
  const MotionClip clip = read_binary_gltf(
      turning_node(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[3]}],"nodes":[)"
                   R"({"name":"Hips","children":[1],"translation":[0,90,0]},)"
                   R"({"name":"Spine","children":[2],"translation":[0,20,5]},)"
                   R"({"name":"Head","translation":[0,50,0]},)"
                   R"({"name":"Armature","children":[0],"scale":[0.01,0.01,0.01]}],)"
                   R"("skins":[{"joints":[0,1,2]}],)"));
  ASSERT_EQ(clip.joints.size(), 3);
  EXPECT_LT((clip.joints[1].offset - Vec3(0, 0.2, 0.05)).norm(), 1e-6);
  EXPECT_LT((clip.joints[2].offset - Vec3(0, 0.5, 0)).norm(), 1e-6);
}

}  // namespace ecorche
