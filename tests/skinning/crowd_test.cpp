#include "skinning/crowd_io.h"

#include <gtest/gtest.h>
#include <tiny_gltf.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>

#include "anatomy/errors.h"
#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// The arm's person, `size` times as large.
Character person(const std::string& name, double size) {
  test::Arm arm = test::make_arm();
  Character out{arm.anatomy, {}};
  out.body.name = name;
  out.body.skin = arm.skin;
  out.body.skin.V *= size;
  for (Joint& joint : out.anatomy.skeleton.joints) joint.X_PJ.translation() *= size;
  for (Bone& bone : out.anatomy.bones) bone.mesh.V *= size;
  for (Muscle& muscle : out.anatomy.muscles)
    for (Strip& strip : muscle.strips) {
      for (PathPoint& p : strip.path) p.rest *= size;
      for (Slice& slice : strip.slices) slice.offset *= size, slice.radii *= size;
    }
  return out;
}

Binding weights_of(const Character& character) {
  Binding out;
  out.vertex_count = static_cast<int>(character.body.skin.V.rows());
  for (int v = 0; v < out.vertex_count; ++v) {
    const double share = 0.5 + 0.5 * std::sin(0.7 * v);
    out.joint_weights.push_back({Influence{2, share}, Influence{3, 1 - share}});
  }
  return out;
}

class CrowdTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  CrowdMember member(const Character& character) {
    const fs::path file = folder / (character.body.name + ".bin");
    write_crowd_person(file, mould, character, weights_of(character).joint_weights);
    return {character.body.name, file, {{"stature_m", 1.7}}, {{"sex", "female"}}};
  }

  fs::path folder = fs::temp_directory_path() / ("crowd-" + std::to_string(getpid()));
  Character pattern = person("pattern", 1);
  CrowdMould mould = make_crowd_mould(pattern);
};

// What a player of glTF makes of a file.
class Crowd {
 public:
  explicit Crowd(const fs::path& file) {
    std::string error, warning;
    tinygltf::TinyGLTF loader;
    const bool ok = file.extension() == ".glb" ? loader.LoadBinaryFromFile(&model_, &error, &warning, file) : loader.LoadASCIIFromFile(&model_, &error, &warning, file);
    EXPECT_TRUE(ok) << error;
  }
  const tinygltf::Model& model() const { return model_; }
  const tinygltf::Node& node(const std::string& name) const {
    for (const tinygltf::Node& node : model_.nodes)
      if (node.name == name) return node;
    throw std::runtime_error(name);
  }
  const tinygltf::Primitive& primitive(const std::string& name) const { return model_.meshes[static_cast<std::size_t>(node(name).mesh)].primitives[0]; }

  // A skinned mesh at rest, world.
  Points rest(const std::string& name) const {
    const tinygltf::Primitive& p = primitive(name);
    const tinygltf::Skin& skin = model_.skins[static_cast<std::size_t>(node(name).skin)];
    std::vector<Eigen::Matrix4d> matrices;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      Eigen::Matrix4f inverse;
      std::memcpy(inverse.data(), at(skin.inverseBindMatrices, j), sizeof inverse);
      Eigen::Matrix4d world = Eigen::Matrix4d::Identity();
      for (int n = skin.joints[j]; n >= 0; n = parent(n))
        world = matrix_of(model_.nodes[static_cast<std::size_t>(n)]) * world;
      matrices.push_back(world * inverse.cast<double>());
    }
    const auto count = model_.accessors[static_cast<std::size_t>(p.attributes.at("POSITION"))].count;
    Points out(static_cast<Eigen::Index>(count), 3);
    for (std::size_t v = 0; v < count; ++v) {
      std::int16_t q[3];
      std::uint8_t joints[4];
      std::uint16_t weights[4];
      std::memcpy(q, at(p.attributes.at("POSITION"), v), sizeof q);
      std::memcpy(joints, at(p.attributes.at("JOINTS_0"), v), sizeof joints);
      std::memcpy(weights, at(p.attributes.at("WEIGHTS_0"), v), sizeof weights);
      EXPECT_EQ(weights[0] + weights[1] + weights[2] + weights[3], 65535);
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      for (int k = 0; k < 4; ++k) sum += weights[k] / 65535.0 * (matrices[joints[k]] * Eigen::Vector4d(q[0] / 32767.0, q[1] / 32767.0, q[2] / 32767.0, 1));
      out.row(static_cast<Eigen::Index>(v)) = sum.head<3>();
    }
    return out;
  }

 private:
  static Eigen::Matrix4d matrix_of(const tinygltf::Node& node) {
    Eigen::Matrix4d out = Eigen::Matrix4d::Identity();
    for (std::size_t k = 0; k < node.scale.size(); ++k) out.col(static_cast<Eigen::Index>(k)) *= node.scale[k];
    for (std::size_t k = 0; k < node.translation.size(); ++k) out(static_cast<Eigen::Index>(k), 3) = node.translation[k];
    return out;
  }
  int parent(int child) const {
    for (std::size_t n = 0; n < model_.nodes.size(); ++n)
      for (int c : model_.nodes[n].children)
        if (c == child) return static_cast<int>(n);
    return -1;
  }
  const unsigned char* at(int accessor, std::size_t i) const {
    const tinygltf::Accessor& a = model_.accessors[static_cast<std::size_t>(accessor)];
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(a.bufferView)];
    return model_.buffers[static_cast<std::size_t>(view.buffer)].data.data() + view.byteOffset + i * static_cast<std::size_t>(a.ByteStride(view));
  }
  tinygltf::Model model_;
};

TEST_F(CrowdTest, PeopleStandAsTheyWereInBothKindsOfFile) {
  const Character tall = person("tall", 1.1), small = person("small", 0.8);
  const std::vector<CrowdMember> members{member(small), member(tall)};
  for (const char* name : {"crowd.glb", "crowd.gltf"}) {
    write_crowd(folder / name, mould, members);
    const Crowd crowd(folder / name);
    const auto apart = [&](const char* who) { return crowd.node(who).translation; };
    for (const Character* one : {&small, &tall}) {
      const std::string& who = one->body.name;
      const auto& t = apart(who.c_str());
      Points asked = one->body.skin.V, read = crowd.rest(who + "/skin");
      ASSERT_EQ(read.rows(), asked.rows());
      read.rowwise() -= Eigen::RowVector3d(t[0], t[1], t[2]);
      EXPECT_LT((read - asked).cwiseAbs().maxCoeff(), 4e-5) << name << " " << who;
      const Points bone = one->anatomy.bones[1].mesh.V;
      const Points bones = crowd.rest(who + "/bones").rowwise() - Eigen::RowVector3d(t[0], t[1], t[2]);
      const CrowdMould::Part& part = mould.layers[1].parts[1];
      EXPECT_EQ(part.name, one->anatomy.bones[1].name);
      ASSERT_EQ(part.vertex_end - part.vertex_begin, bone.rows());
      EXPECT_LT((bones.middleRows(part.vertex_begin, bone.rows()) - bone).cwiseAbs().maxCoeff(), 4e-5);
      const Points muscles = crowd.rest(who + "/muscles").rowwise() - Eigen::RowVector3d(t[0], t[1], t[2]);
      const double scale = one == &small ? 0.8 : 1.1;
      for (Eigen::Index v = 0; v < muscles.rows(); ++v) ASSERT_LT((muscles.row(v) / scale - Eigen::RowVector3d(0.2, 1.25, 0)).norm(), 0.25);
      EXPECT_EQ(crowd.node(who).extras.Get("sex").Get<std::string>(), "female");
      EXPECT_DOUBLE_EQ(crowd.node(who).extras.Get("stature_m").GetNumberAsDouble(), 1.7);
    }
    EXPECT_GT(std::abs(apart("tall")[0] - apart("small")[0]) + std::abs(apart("tall")[2] - apart("small")[2]), 1.0);
  }
}

TEST_F(CrowdTest, WhatPeopleHaveInCommonIsThereOnce) {
  std::vector<CrowdMember> members;
  for (int i = 0; i < 4; ++i) members.push_back(member(person("p" + std::to_string(i), 0.9 + 0.05 * i)));
  write_crowd(folder / "four.glb", mould, members);
  write_crowd(folder / "one.glb", mould, {members[0]});
  const Crowd crowd(folder / "four.glb");
  for (const char* layer : {"skin", "bones", "muscles"}) {
    const bool own_weights = std::string(layer) == "skin";
    std::set<int> shared, own;
    for (const CrowdMember& m : members) {
      const tinygltf::Primitive& p = crowd.primitive(m.name + "/" + layer);
      shared.insert(p.indices);
      (own_weights ? own : shared).insert({p.attributes.at("JOINTS_0"), p.attributes.at("WEIGHTS_0")});
      own.insert({p.attributes.at("POSITION"), p.attributes.at("NORMAL")});
    }
    EXPECT_EQ(shared.size(), own_weights ? 1u : 3u);
    EXPECT_EQ(own.size(), own_weights ? 16u : 8u);
  }
  // A person more costs its own file, and text.
  const auto more = fs::file_size(folder / "four.glb") - fs::file_size(folder / "one.glb");
  EXPECT_LT(more, 3 * (fs::file_size(members[0].file) + 6000));
}

TEST_F(CrowdTest, APersonDependsOnNobodyElse) {
  const CrowdMember a = member(person("a", 1.0)), b = member(person("b", 0.9));
  write_crowd(folder / "first.glb", mould, {a, b});
  const std::string before = bytes_of(b.file);
  fs::remove(a.file), fs::remove(b.file);
  member(person("b", 0.9)), member(person("a", 1.0));
  EXPECT_EQ(bytes_of(b.file), before);
  write_crowd(folder / "second.glb", mould, {a, b});
  EXPECT_EQ(bytes_of(folder / "first.glb"), bytes_of(folder / "second.glb"));
}

TEST_F(CrowdTest, WhatDoesNotBelongIsRefused) {
  Character other = person("other", 1);
  other.body.skin = test::make_arm(1, true, 40).skin;
  EXPECT_THROW(write_crowd_person(folder / "other.bin", mould, other, weights_of(other).joint_weights), UnfitError);
  EXPECT_FALSE(fs::exists(folder / "other.bin"));
  CrowdMember a = member(person("a", 1));
  EXPECT_THROW(write_crowd(folder / "twice.glb", mould, {a, a}), UsageError);
  EXPECT_THROW(write_crowd(folder / "crowd.obj", mould, {a}), UsageError);
  std::ofstream(a.file, std::ios::app) << "more";
  EXPECT_THROW(write_crowd(folder / "long.glb", mould, {a}), InputError);
  fs::remove(a.file);
  EXPECT_THROW(write_crowd(folder / "gone.glb", mould, {a}), InputError);
  EXPECT_FALSE(fs::exists(folder / "long.glb") || fs::exists(folder / "gone.glb"));
}

}  // namespace
}  // namespace ecorche
