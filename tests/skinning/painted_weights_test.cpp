// Laws of weights set by hand: they are what the table says, what is written is read back, and a
// bad table is refused with its line.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "anatomy/errors.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "skinning/bind/painted_weights.h"
#include "tests/skinning/arm.h"
#include "tests/skinning/compiled_arm.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct Bound {
  test::Arm arm = test::make_arm();
  PosingTable table = make_posing_table(arm.anatomy);

  PosedAnatomy posed(double angle) const {
    Pose pose = rest_pose(arm.anatomy.skeleton);
    pose.rotations[3] = Quat(Eigen::AngleAxisd(-angle, Vec3::UnitX()));
    PosedAnatomy out;
    pose_anatomy(table, arm.anatomy.skeleton, pose, out);
    return out;
  }
  CharacterModel bound(const PaintedWeights& painted = {}) const {
    return test::compile_without_collision(arm.anatomy, arm.skin, {.painted = painted});
  }
  Points skin(const CharacterModel& model, double angle, bool blended = false) const {
    CharacterState state(model);
    state.posed = posed(angle);
    Points out;
    to_points(blended ? evaluate_blended_skin(model.skin, state)
                      : evaluate_posed_skin(model.skin, {}, state),
              out);
    return out;
  }
};

class PaintedWeightsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string name = std::string("ecorche_weights_") +
                             ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                             ".csv";
    file_ = fs::temp_directory_path() / name;
  }
  void TearDown() override { fs::remove(file_); }

  PaintedWeights read(const std::string& rows) {
    std::ofstream(file_) << "vertex,joint,weight\n" << rows;
    return read_painted_weights(file_, bound_.arm.anatomy, int(bound_.arm.skin.V.rows()));
  }
  std::string refused(const std::string& rows) {
    try {
      read(rows);
    } catch (const InputError& error) {
      return error.what();
    }
    return "not refused";
  }

  Bound bound_;
  fs::path file_;
};

TEST_F(PaintedWeightsTest, WhatIsWrittenMovesTheSkinAsBefore) {
  const CharacterModel found = bound_.bound();
  write_weights(file_, bound_.arm.anatomy.skeleton, *found.skin.blend);
  const PaintedWeights painted =
      read_painted_weights(file_, bound_.arm.anatomy, found.binding.vertex_count);
  ASSERT_EQ(int(painted.vertices.size()), found.binding.vertex_count);
  const CharacterModel again = bound_.bound(painted);
  EXPECT_LT((bound_.skin(found, 1.8) - bound_.skin(again, 1.8)).cwiseAbs().maxCoeff(), 1e-5);
  const auto before = joint_weights_of(*found.skin.blend),
             after = joint_weights_of(*again.skin.blend);
  for (std::size_t i = 0; i < before.size(); ++i) {
    double sum = 0;
    for (const Influence& w : after[i]) sum += w.weight;
    EXPECT_NEAR(sum, 1, 1e-5);
    ASSERT_EQ(before[i].size(), after[i].size());
    for (std::size_t k = 0; k < before[i].size(); ++k)
      EXPECT_NEAR(before[i][k].weight, after[i][k].weight, 1e-5);
  }
}

TEST_F(PaintedWeightsTest, APaintedVertexGoesWithItsJointAlone) {
  const TriMesh& skin = bound_.arm.skin;
  int lowest = 0;  // at the hand's end
  for (int i = 0; i < skin.V.rows(); ++i)
    if (skin.V(i, 1) < skin.V(lowest, 1)) lowest = i;
  const PaintedWeights painted = read(std::to_string(lowest) + ",thorax,1\n");
  const CharacterModel plain = bound_.bound(), bound = bound_.bound(painted);
  const Points before = bound_.skin(plain, 1.5, true), after = bound_.skin(bound, 1.5, true);
  EXPECT_LT((after.row(lowest) - skin.V.row(lowest)).norm(), 1e-6);  // the thorax holds still
  EXPECT_GT((before.row(lowest) - skin.V.row(lowest)).norm(), 0.2);
  ASSERT_EQ(joint_weights_of(*bound.skin.blend)[lowest].size(), 1u);
  int moved = 0;
  for (Eigen::Index i = 0; i < skin.V.rows(); ++i)
    moved += (after.row(i) - before.row(i)).norm() > 1e-3;
  EXPECT_EQ(moved, 1);
}

TEST_F(PaintedWeightsTest, ABonesNameStandsForItsJoint) {
  const PaintedWeights painted = read("3,ulna_l,0.25\n3,elbow_l,0.25\n3,humerus_l,0.5\n");
  ASSERT_EQ(painted.weights.size(), 1u);
  ASSERT_EQ(painted.weights[0].size(), 2u);
  EXPECT_EQ(painted.weights[0][0].joint, find_joint(bound_.arm.anatomy.skeleton, "shoulder_l"));
  EXPECT_DOUBLE_EQ(painted.weights[0][0].weight, 0.5);
  EXPECT_DOUBLE_EQ(painted.weights[0][1].weight, 0.5);
}

TEST_F(PaintedWeightsTest, RefusesWhatCannotBeMeant) {
  EXPECT_NE(refused("0,thorax,1\n900000,thorax,1\n").find(".csv:3: there is no vertex 900000"),
            std::string::npos);
  EXPECT_NE(refused("-1,thorax,1\n").find("no vertex -1"), std::string::npos);
  EXPECT_NE(refused("1.5,thorax,1\n").find("no vertex 1.5"), std::string::npos);
  EXPECT_NE(refused("0,wing,1\n").find("'wing' is no joint"), std::string::npos);
  EXPECT_NE(refused("0,thorax,-0.2\n0,shoulder_l,1\n").find("not between 0 and 1"),
            std::string::npos);
  EXPECT_NE(refused("0,thorax,nan\n").find(":2"), std::string::npos);
  EXPECT_NE(refused("0,thorax,0.6\n").find("vertex 0 add up to 0.6"), std::string::npos);
  EXPECT_NE(refused("0,thorax,0.5\n0,thorax,0.5\n").find("twice"), std::string::npos);
  EXPECT_NE(refused("").find("no weights"), std::string::npos);
}

}  // namespace
}  // namespace ecorche
