// A motion as shapes times curves, and files that any viewer plays as the program does.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "anatomy/geometry/simplify.h"
#include "skinning/files/character_read.h"
#include "skinning/files/character_write.h"
#include "skinning/files/clip_shapes.h"
#include "skinning/files/layer_mesh.h"
#include "skinning/files/light_character.h"
#include "skinning/morphs/join_shapes.h"
#include "skinning/morphs/linear_blend.h"
#include "skinning/morphs/morph_basis.h"
#include "tests/skinning/compiled_arm.h"
#include "tests/skinning/played_file.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;
using Eigen::MatrixXf;

// #places x #frames: a few movements, and what no shape can follow.
MatrixXf moving(int vertices, int frames, int movements, float noise) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  const auto draw = [&](Eigen::Index rows, Eigen::Index cols) {
    MatrixXf out(rows, cols);
    for (float& x : out.reshaped()) x = normal(random);
    return out;
  };
  const MatrixXf shapes = 0.01f * draw(3 * vertices, movements), curves = draw(movements, frames);
  return shapes * curves + noise * draw(3 * vertices, frames);
}

MeshShapes basis_of(const MatrixXf& offsets, const ShapeOptions& options = {}) {
  MorphBasis basis(offsets.rows() / 3, options);
  for (Eigen::Index f = 0; f < offsets.cols(); ++f) basis.add(offsets.col(f));
  return basis.finish();
}

double largest_error(const MeshShapes& shapes, const MatrixXf& offsets) {
  const MatrixXf off = offsets - shapes.shapes * shapes.curves.transpose();
  return std::sqrt(double(off.reshaped(3, off.size() / 3).colwise().squaredNorm().maxCoeff()));
}

TEST(MorphBasis, FindsAsManyShapesAsThereAreMovements) {
  const MatrixXf offsets = moving(200, 90, 5, 2e-6f);
  const MeshShapes shapes = basis_of(offsets);
  EXPECT_EQ(shapes.shapes.cols(), 5 + 1);  // and where they stand
  EXPECT_EQ(shapes.curves.rows(), 90);
  EXPECT_GE(shapes.curves.minCoeff(), 0);
  EXPECT_LE(shapes.curves.maxCoeff(), 1 + 1e-6f);
  EXPECT_LT(largest_error(shapes, offsets), 3e-4);
}

TEST(MorphBasis, StatesTheErrorThatItLeaves) {
  for (const int most : {3, 32}) {
    const MatrixXf offsets = moving(150, 60, 8, 4e-4f);
    const MeshShapes shapes = basis_of(offsets, {.most = most});
    const double error = largest_error(shapes, offsets);
    EXPECT_LE(shapes.shapes.cols(), most + 1);
    EXPECT_LE(error, 1.001 * shapes.max_error);
    EXPECT_GE(error, 0.2 * shapes.max_error);  // bounds add up
    const MatrixXf off = offsets - shapes.shapes * shapes.curves.transpose();
    EXPECT_NEAR(std::sqrt(double(off.squaredNorm()) / (150.0 * 60.0)), shapes.rms_error,
                0.05 * shapes.rms_error);
    if (most == 32) EXPECT_LE(error, 8.5e-3);
  }
}

// More frames, all different, than a basis may grow to.
TEST(MorphBasis, LongMotionsStayWithinBounds) {
  const MatrixXf offsets = moving(140, 700, 4, 3e-4f);
  const MeshShapes shapes = basis_of(offsets);
  EXPECT_EQ(shapes.curves.rows(), 700);
  EXPECT_LE(shapes.shapes.cols(), 65);
  EXPECT_LE(largest_error(shapes, offsets), 1.001 * shapes.max_error);
}

TEST(MorphBasis, WhatStandsStillHasNoShapes) {
  const MeshShapes shapes = basis_of(MatrixXf::Zero(30, 7));
  EXPECT_EQ(shapes.shapes.rows(), 30);
  EXPECT_EQ(shapes.shapes.cols(), 0);
  EXPECT_EQ(shapes.curves.rows(), 7);
}

TEST(JoinShapes, MovesEachMeshAsBefore) {
  const MatrixXf offsets = moving(90, 40, 6, 0);
  std::vector<MeshShapes> parts;
  for (int part = 0; part < 3; ++part) parts.push_back(basis_of(offsets.middleRows(90 * part, 90)));
  const MeshShapes joined = join_shapes(parts, {});
  EXPECT_LE(joined.shapes.cols(), 8);  // not three times as many
  EXPECT_LE(largest_error(joined, offsets), 1.001 * joined.max_error);
  std::vector<int> rows;
  for (int i = 30; i < 60; ++i) rows.push_back(i);
  EXPECT_LE(largest_error(shape_rows(joined, rows), offsets.middleRows(90, 90)),
            1.001 * joined.max_error);
}

TEST(LinearBlend, OffsetsBringVerticesToTheirPlaces) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  BlendedMesh mesh;
  std::vector<float> wanted;
  for (int i = 0; i < 50; ++i) {
    const double share = 0.5 + 0.5 * any(random);
    mesh.influences.push_back({Influence{0, share}, Influence{1, 1 - share}});
    for (int k = 0; k < 3; ++k) {
      mesh.positions.push_back(float(any(random)));
      wanted.push_back(float(any(random)));
    }
  }
  const std::vector<Affine> moves{
      Affine(Eigen::AngleAxisd(0.4, Vec3::UnitX())),
      Eigen::Translation3d(0.1, 0, 0) * Eigen::AngleAxisd(-1.2, Vec3(1, 2, 3).normalized())};
  Eigen::VectorXf offsets;
  const double collapsed = offsets_at_rest(mesh, moves, wanted, 3, offsets);
  EXPECT_LT(collapsed, 2e-3);
  for (std::size_t i = 0; i < 50; ++i) {
    const Vec3 offset = offsets.segment<3>(3 * Eigen::Index(i)).cast<double>(),
               there = blend_vertex(mesh, moves, i, offset);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(there[k], double(wanted[3 * i + std::size_t(k)]), 2e-3);
  }
}

test::Arm sound_arm() {
  test::Arm arm = test::make_arm();
  arm.anatomy.muscles[0].strips[0].rest_length = 0.31;
  return arm;
}

// An arm that bends and swells, as the program evaluates it.
class ClipTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder);
    motion.fps = 30;
    ClipRecorder recorder(model.character, model.binding);
    CharacterState state(model);
    for (int f = 0; f < 24; ++f) {
      Pose pose = rest_pose(model.character.anatomy.skeleton);
      pose.root.z() += 0.02 * f;
      pose.rotations[2] = Quat(Eigen::AngleAxisd(0.02 * f, Vec3::UnitZ()));
      pose.rotations[3] = Quat(Eigen::AngleAxisd(-0.09 * f, Vec3::UnitX()));
      const double activation = 0.5 + 0.5 * std::sin(0.7 * f);
      evaluate(model, pose, {.activation = {&activation, 1}}, state);
      PointsF muscles;
      pose_layer(layer, state.posed, state.skin, muscles);
      exact_muscles.push_back(muscles.cast<double>());
      Points skin;
      to_points(state.skin, skin);
      exact_skins.push_back(skin);
      recorder.add(state.posed, state.skin);
      motion.frames.push_back(pose);
    }
    shapes = recorder.finish();
  }
  void TearDown() override { fs::remove_all(folder); }

  fs::path folder = fs::temp_directory_path() / ("ecorche-morphs-" + std::to_string(::getpid()));
  test::Arm arm = sound_arm();
  CharacterModel model = test::compile_figure(arm.anatomy, arm.skin);
  LayerMesh layer = muscle_layer(arm.anatomy);
  Motion motion;
  std::vector<Points> exact_muscles, exact_skins;
  ClipShapes shapes;
};

TEST_F(ClipTest, FilesShowMusclesAndSkinAsTheProgramHasThem) {
  const fs::path file = folder / "a.glb", plain = folder / "b.glb";
  write_character(file, model.character, model.binding, &motion, {}, &shapes);
  write_character(plain, model.character, model.binding, &motion);
  test::PlayedFile played(file), by_joints(plain);
  double muscle_off = 0, skin_off = 0, joints_off = 0;
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    played.play(f);
    by_joints.play(f);
    const auto off = [&](const test::PlayedFile& one, const char* name, const Points& exact) {
      const Points there = one.world(name);
      EXPECT_EQ(there.rows(), exact.rows());
      return (there - exact).rowwise().norm().maxCoeff();
    };
    muscle_off = std::max(muscle_off, off(played, "muscle/biceps_l", exact_muscles[f]));
    skin_off = std::max(skin_off, off(played, "skin", exact_skins[f]));
    joints_off = std::max(joints_off, off(by_joints, "muscle/biceps_l", exact_muscles[f]));
  }
  constexpr double kRounding = 5e-5;  // m: weights of 16 bits
  EXPECT_LE(muscle_off, shapes.muscles[0].max_error + kRounding);
  EXPECT_LE(skin_off, shapes.skin.max_error + kRounding);
  EXPECT_LE(shapes.muscles[0].max_error, 8.5e-3);
  EXPECT_GT(joints_off, 0.01);  // what the shapes are for
}

TEST_F(ClipTest, FilesWithShapesAreStillCharacters) {
  write_character(folder / "a.glb", model.character, model.binding, &motion, {}, &shapes);
  const Character out = read_character(folder / "a.glb");
  ASSERT_EQ(out.anatomy.muscles.size(), 1u);
  EXPECT_EQ(out.anatomy.muscles[0].strips[0].slices.size(),
            arm.anatomy.muscles[0].strips[0].slices.size());
  EXPECT_LT((out.body.skin.V - arm.skin.V).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(ClipTest, LightFilesMoveTheSame) {
  write_light_character(folder / "low.glb", model.character, model.binding, kLowDetail, &motion, {},
                        &shapes);
  test::PlayedFile played(folder / "low.glb");
  for (const std::size_t f : {std::size_t{0}, std::size_t{11}, std::size_t{23}}) {
    played.play(f);
    const Points there = played.world("muscles/neck");  // the arm's muscle is of no group
    const std::vector<int> nearest = nearest_rows(there, exact_muscles[f]);
    for (Eigen::Index i = 0; i < there.rows(); ++i)
      ASSERT_LT((there.row(i) - exact_muscles[f].row(nearest[std::size_t(i)])).norm(), 5e-3);
    EXPECT_LE((played.world("skin") - exact_skins[f]).rowwise().norm().maxCoeff(),
              shapes.skin.max_error + 5e-5);
  }
}

TEST_F(ClipTest, ShapesOfAnotherMotionAreRefused) {
  Motion shorter = motion;
  shorter.frames.pop_back();
  EXPECT_THROW(
      write_character(folder / "a.glb", model.character, model.binding, &shorter, {}, &shapes),
      std::invalid_argument);
  EXPECT_THROW(
      write_character(folder / "a.glb", model.character, model.binding, nullptr, {}, &shapes),
      std::invalid_argument);
}

TEST_F(ClipTest, SameInputSameBytes) {
  for (const char* name : {"a.glb", "b.glb"})
    write_character(folder / name, model.character, model.binding, &motion, {}, &shapes);
  const auto bytes = [&](const char* name) {
    std::ifstream in(folder / name, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(in), {}};
  };
  EXPECT_EQ(bytes("a.glb"), bytes("b.glb"));
}

}  // namespace
}  // namespace ecorche
