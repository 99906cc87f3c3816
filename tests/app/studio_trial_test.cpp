// What a document is tried in: efforts over time, what it is compared with, what is measured of a
// muscle, shots of films, files of sessions before.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "anatomy/errors.h"
#include "anatomy/muscles/action_line.h"
#include "app/edit/comparison.h"
#include "app/edit/muscle_gauge.h"
#include "app/edit/palpable_points.h"
#include "app/edit/recent_files.h"
#include "app/edit/session.h"
#include "app/edit/trial_pose.h"
#include "app/pages/film_shots.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

class StudioTrial : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("trial." + std::to_string(getpid()));
    fs::create_directories(folder_);
    common_.assets = test_assets();
    common_.quiet = true;
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Muscles of these names, left and right.
  static Anatomy named(std::initializer_list<const char*> names) {
    Anatomy out;
    for (const char* name : names)
      for (const char* side : {"_l", "_r"})
        out.muscles.emplace_back().name = std::string(name) + side;
    return out;
  }

  fs::path folder_;
  Common common_;
  Report report_;
};

// One joint, and a muscle of one strip across it, 30 cm long and 3 cm from it.
Anatomy hinge() {
  Anatomy out;
  Joint root, turns;
  root.name = "root";
  turns.name = "hinge_l";
  turns.parent = 0;
  turns.min = Vec3(-2, -2, -2);
  turns.max = Vec3(2, 2, 2);
  out.skeleton.joints = {root, turns};
  std::vector<PathPoint> path(3);
  for (int i = 0; i < 3; ++i) {
    path[std::size_t(i)].rest = Vec3(0, 0.15 - 0.15 * i, 0.03);
    path[std::size_t(i)].joints = {i == 2 ? 1 : 0, -1};
  }
  std::vector<Station> stations;
  for (int k = 0; k < 9; ++k)
    stations.push_back({k / 8.0, Vec3::Zero(), Vec3::UnitX(), Vec2(0.02, 0.015)});
  Muscle muscle;
  muscle.name = "over_l";
  muscle.side = Side::left;
  muscle.volume = 1.2e-4;
  muscle.fibre_length = 0.1;
  muscle.max_force = 500;
  muscle.strips = {make_strip(path, stations)};
  out.muscles = {muscle};
  return out;
}

TEST_F(StudioTrial, EffortsGoStraightFromKeyToKeyAndStayBeyondThem) {
  Session s(common_, report_, {});
  const Anatomy anatomy = named({"soleus", "plantaris"});
  const auto effort = [&](double seconds) {
    return trial_activation(s.document(), anatomy, seconds).front();
  };
  s.run_line("activate soleus value=0.2 at=1s");
  s.run_line("activate soleus value=0.8 at=2s");
  EXPECT_DOUBLE_EQ(effort(0), 0.2);
  EXPECT_DOUBLE_EQ(effort(1.5), 0.5);
  EXPECT_DOUBLE_EQ(effort(9), 0.8);
  EXPECT_DOUBLE_EQ(trial_activation(s.document(), anatomy, 1.5)[2], 0);
  s.run_line("activate soleus value=0.8 at=3s from=2s");
  EXPECT_DOUBLE_EQ(effort(2), 0.5);
  s.run_line("relax soleus at=1s");
  EXPECT_DOUBLE_EQ(effort(0), 0.8);
  s.run_line("relax soleus at=3s");  // the last key takes the curve with it
  EXPECT_DOUBLE_EQ(effort(3), 0);
  EXPECT_TRUE(s.document().trial->activations.empty());
  s.run_line("activate soleus value=0.4 at=1s");
  s.run_line("activate soleus value=0.6");  // all the time, in place of the curve
  EXPECT_DOUBLE_EQ(effort(1), 0.6);
}

TEST_F(StudioTrial, AGroupIsAllItsMusclesAndNoOther) {
  Session s(common_, report_, {});
  s.run_line("activate nerve:femoral_nerve value=1");
  const std::map<std::string, TriedEffort> efforts = s.document().trial->activations;
  for (const char* name : {"rectus_femoris", "vastus_lateralis", "sartorius", "iliacus"})
    EXPECT_TRUE(efforts.contains(name)) << name;
  for (const char* name : {"gracilis", "soleus", "*"}) EXPECT_FALSE(efforts.contains(name)) << name;
  s.run_line("relax function:knee_extension");
  EXPECT_FALSE(s.document().trial->activations.contains("vastus_lateralis"));
  EXPECT_TRUE(s.document().trial->activations.contains("sartorius"));
}

TEST_F(StudioTrial, AMotionTakesThePlaceOfAPose) {
  Session s(common_, report_, {});
  if (!fs::exists(common_.assets.packages.folder)) GTEST_SKIP() << "no data packages";
  std::ofstream(folder_ / "walk.bvh") << "";
  s.run_line("pose squat");
  s.run_line("play_motion " + (folder_ / "walk.bvh").string());
  EXPECT_EQ(s.document().trial->pose, "");
}

TEST_F(StudioTrial, WhatItIsComparedWithIsTheSavedTheOneBeforeOrAnotherBodyInTheSameTrial) {
  Session s(common_, report_, {});
  s.run_line("compare saved");
  ASSERT_TRUE(s.compared());
  EXPECT_EQ(s.compared()->muscles, s.workshop().built_in().muscles);
  s.run_line("compare before");
  EXPECT_FALSE(s.compared()) << "nothing was edited";
  s.run_line("set_muscle soleus fibre=5");
  s.run_line("move_point soleus point=2 by=0,0,1");
  s.run_line("activate soleus value=0.5");
  const std::optional<Document> before = s.compared();
  ASSERT_TRUE(before);
  EXPECT_EQ(before->trial, s.document().trial);
  EXPECT_NE(before->muscles, s.document().muscles);
  EXPECT_NE(before->muscles, s.workshop().built_in().muscles) << "one edit back, not both";
  std::ofstream(folder_ / "other.glb") << "";
  s.run_line("compare " + (folder_ / "other.glb").string());
  ASSERT_TRUE(s.compared());
  EXPECT_EQ(s.compared()->body->file, folder_ / "other.glb");
  EXPECT_EQ(s.compared()->muscles, s.document().muscles);
  EXPECT_EQ(compared_names(s.document()).other, "other");
  s.run_line("compare linear_blend");
  EXPECT_FALSE(s.compared()) << "the same document, another skin";
  s.run_line("compare none");
  EXPECT_FALSE(s.compared());
}

TEST_F(StudioTrial, AMuscleThatShortensBulgesAndPullsByItsCurves) {
  const Anatomy anatomy = hinge();
  const MuscleGauge gauge(anatomy, 0, 1, 0);
  Pose rest = rest_pose(anatomy.skeleton), bent = rest;
  bent.rotations[1] = Quat(Eigen::AngleAxisd(-0.8, Vec3::UnitX()));
  const double at_rest = gauge.length(rest, 0), short_ = std::min(gauge.length(bent, 0), at_rest);
  EXPECT_NEAR(at_rest, 0.3, 0.002);
  EXPECT_NEAR(gauge.bulge(rest, 0), 1, 1e-6);
  EXPECT_GT(gauge.bulge(rest, 1), 1.01) << "the belly shortens against its tendon";
  if (short_ < at_rest - 0.005) {
    EXPECT_GT(gauge.bulge(bent, 0), 1.005);
  }
  // relaxed at rest it pulls by nothing, at full effort by nearly all, less where it shortens fast
  EXPECT_NEAR(gauge.force(at_rest, 0, 0), 0, 1e-6);
  const double held = gauge.force(at_rest, 0, 1);
  EXPECT_GT(held, 400);
  EXPECT_LE(held, 500);
  EXPECT_LT(gauge.force(at_rest, -0.3, 1), 0.7 * held);
  EXPECT_GT(gauge.force(at_rest, 0.3, 1), held);
  EXPECT_GT(gauge.force(at_rest + 0.06, 0, 0), 10) << "fibres that are stretched far pull back";
}

TEST_F(StudioTrial, CurvesHaveARowAFrameAndSpeedsOfTheirLengths) {
  const Anatomy anatomy = hinge();
  const MuscleGauge gauge(anatomy, 0, 1, 0);
  MuscleCurves curves;
  Pose pose = rest_pose(anatomy.skeleton);
  for (int k = 0; k < 20; ++k) {
    pose.rotations[1] = Quat(Eigen::AngleAxisd(0.03 * k, Vec3::UnitX()));
    add_frame(gauge, pose, 0.05 * k, curves);
  }
  finish(gauge, 50, curves);
  ASSERT_EQ(curves.forces.size(), 20u);
  EXPECT_NEAR(curves.speeds[7], (curves.lengths[8] - curves.lengths[6]) * 25, 1e-9);
  ASSERT_TRUE(curves.moment_arms[7]);
  // what the length changes by the angle is the moment arm
  const double by_angle = (curves.lengths[8] - curves.lengths[6]) / 0.06;
  EXPECT_NEAR(std::abs(by_angle), std::abs(*curves.moment_arms[7]), 1e-3);
  const std::string table = table_of(curves, 50);
  EXPECT_EQ(std::ranges::count(table, '\n'), 21);
  EXPECT_TRUE(
      table.starts_with("seconds,length_mm,speed_mm_s,moment_arm_mm,activation,force_n,bulge"));
}

TEST_F(StudioTrial, ShotsSayCameraSpanAndTime) {
  const auto shots = read_shots("front 0-1.5; left@knee_l 1-2 4s;around 6s", 0.7, true, "shots");
  ASSERT_EQ(shots.size(), 3u);
  EXPECT_EQ(shots[0].view.camera, "front");
  EXPECT_DOUBLE_EQ(shots[0].seconds, 1.5);
  EXPECT_EQ(shots[1].view.look_at, "knee_l");
  EXPECT_DOUBLE_EQ(shots[1].span.begin, 1);
  EXPECT_DOUBLE_EQ(shots[1].seconds, 4);
  EXPECT_DOUBLE_EQ(shots[2].turns, 1);
  EXPECT_DOUBLE_EQ(shots[2].span.begin, 0.7) << "it stands at the moment that is shown";
  EXPECT_DOUBLE_EQ(shots[2].span.end, 0.7);
  for (const char* bad : {"", "frnt 2s", "front 2-1", "front 2", "front 3000s", "front 1-2 x"})
    EXPECT_THROW(read_shots(bad, 0, true, "shots"), InputError) << bad;
  EXPECT_THROW(read_shots("front 0-1", 0, false, "shots"), InputError) << "there is no motion";
}

TEST_F(StudioTrial, RecentFilesAreTheLatestFirstAndThoseThatAreThere) {
  for (const char* name : {"a.glb", "b.bvh", "c.glb"}) std::ofstream(folder_ / name) << "x";
  const fs::path states = folder_ / "states";
  EXPECT_TRUE(recent_files(states).empty());
  note_recent(states, {"body", folder_ / "a.glb"});
  note_recent(states, {"motion", folder_ / "b.bvh"});
  note_recent(states, {"body", folder_ / "c.glb"});
  note_recent(states, {"body", folder_ / "a.glb"});
  std::vector<RecentFile> all = recent_files(states);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].file, folder_ / "a.glb");
  EXPECT_EQ(all[2].kind, "motion");
  fs::remove(folder_ / "c.glb");
  EXPECT_EQ(recent_files(states).size(), 2u);
  for (int k = 0; k < 30; ++k) {
    const fs::path file = folder_ / ("m" + std::to_string(k));
    std::ofstream(file) << "x";
    note_recent(states, {"motion", file});
  }
  EXPECT_EQ(recent_files(states).size(), 20u);
  std::ofstream(states / "recent.txt") << "nonsense\nbody relative.glb\nbody\n";
  EXPECT_TRUE(recent_files(states).empty());
  EXPECT_TRUE(recent_files({}).empty());
}

TEST_F(StudioTrial, PointsOutOfBoundsComeFurthestFirst) {
  const std::vector<LandmarkDepth> points{{"in_bounds", 0.010, 0.008, 0.012},
                                          {"a_little", 0.020, 0.008, 0.012},
                                          {"far_off", 0.050, 0.008, 0.012},
                                          {"too_near", 0.001, 0.010, 0.012}};
  const std::vector<LandmarkDepth> off = points_off(points);
  ASSERT_EQ(off.size(), 3u);
  EXPECT_EQ(off[0].name, "far_off");
  EXPECT_EQ(off[2].name, "a_little");
  EXPECT_EQ(point_text(off[0]), "far off: 50 mm under the skin, people have 8 to 12");
}

}  // namespace
}  // namespace ecorche
