// Layers as meshes: what vertex caches hold and the OBJ files they go on.
#include "skinning/files/layer_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "anatomy/mesh_files/mesh_io.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

struct Posed {
  test::Arm arm = test::make_arm(1, true);
  PosedAnatomy posed;
  Posed() {
    Strip& strip = arm.anatomy.muscles[0].strips[0];
    strip.belly_begin = 0.2;
    strip.belly_end = 0.8;
    Pose pose = rest_pose(arm.anatomy.skeleton);
    pose.rotations[3] = Quat(Eigen::AngleAxisd(-1.1, Vec3::UnitX()));
    pose_anatomy(make_posing_table(arm.anatomy), arm.anatomy.skeleton, pose, posed);
  }
};

TEST(LayerMesh, BonesRideOnTheirJoints) {
  const Posed one;
  const LayerMesh layer = bone_layer(one.arm.anatomy, {});
  PointsF out;
  pose_layer(layer, one.posed, {}, out);
  const auto rest = rest_positions(one.arm.anatomy.skeleton);
  Eigen::Index row = 0;
  for (const Bone& bone : one.arm.anatomy.bones)
    for (Eigen::Index i = 0; i < bone.mesh.V.rows(); ++i, ++row) {
      const std::size_t j = bone.joint;
      const Vec3 there = one.posed.X_WJ[j] * (bone.mesh.V.row(i).transpose() - rest[j]);
      ASSERT_LT((out.row(row).transpose().cast<double>() - there).norm(), 1e-6) << bone.name;
    }
  EXPECT_EQ(row, out.rows());
}

TEST(LayerMesh, MusclesAreThoseOfTheSurface) {
  const Posed one;
  const LayerMesh layer = muscle_layer(one.arm.anatomy);
  PointsF out;
  pose_layer(layer, one.posed, {}, out);
  Points surface;
  update_muscle_surface(layer.surface, one.posed, surface);
  EXPECT_LT((out.cast<double>() - surface).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_GT((out - layer.rest).cwiseAbs().maxCoeff(), 0.01f);
  Eigen::Index faces = 0;
  for (const MeshGroup& group : layer.groups) faces += group.F.rows();
  EXPECT_EQ(faces, layer.surface.F.rows());
}

// Every layer's faces name its own vertices, whatever goes before, and a file of them reads back.
TEST(LayerMesh, FilesCountVerticesOn) {
  const Posed one;
  const std::vector<LayerMesh> layers{skin_layer(one.arm.skin, {}), muscle_layer(one.arm.anatomy),
                                      bone_layer(one.arm.anatomy, {})};
  std::string text = "mtllib nowhere.mtl\n";
  Eigen::Index vertices = 0, faces = 0;
  for (const LayerMesh& layer : layers) {
    append_vertices({layer.rest.data(), std::size_t(layer.rest.size())}, 3, text);
    vertices += layer.rest.rows();
    for (const MeshGroup& group : layer.groups) faces += group.F.rows();
  }
  text += layer_faces(layers);
  const TriMesh mesh = all_parts(parse_mesh(text, "layers.obj"));
  ASSERT_EQ(mesh.V.rows(), vertices);
  ASSERT_EQ(mesh.F.rows(), faces);
  EXPECT_EQ(mesh.V.row(one.arm.skin.V.rows()).cast<float>(), layers[1].rest.row(0));
  // Groups lie in their own layer's vertices: no face joins two layers.
  const Eigen::Index first = layers[0].rest.rows(), second = first + layers[1].rest.rows();
  for (Eigen::Index f = 0; f < faces; ++f) {
    const auto layer_of = [&](int v) { return v < first ? 0 : v < second ? 1 : 2; };
    ASSERT_EQ(layer_of(mesh.F(f, 0)), layer_of(mesh.F(f, 1))) << f;
    ASSERT_EQ(layer_of(mesh.F(f, 0)), layer_of(mesh.F(f, 2))) << f;
  }
  for (const char* wanted :
       {"g skin\n", "g bone/", "g muscle/", "usemtl tendon\n", "usemtl muscle\n"})
    EXPECT_NE(text.find(wanted), std::string::npos) << wanted;
  for (const char* wanted :
       {"newmtl skin\n", "newmtl bone\n", "newmtl muscle\n", "newmtl tendon\n"})
    EXPECT_NE(layer_materials(layers).find(wanted), std::string::npos) << wanted;
}

TEST(LayerMesh, SkinsAreTakenAsTheyAre) {
  const Posed one;
  const LayerMesh layer = skin_layer(one.arm.skin, {});
  SkinFrame frame;
  for (Eigen::Index i = 0; i < one.arm.skin.V.rows(); ++i)
    for (int k = 0; k < 4; ++k) frame.positions.push_back(float(10 * i + k));
  PointsF out;
  pose_layer(layer, one.posed, frame, out);
  EXPECT_EQ(out(3, 1), 31);
  frame.positions.pop_back();
  EXPECT_THROW(pose_layer(layer, one.posed, frame, out), std::invalid_argument);
}

}  // namespace
}  // namespace ecorche
