#include "skinning/crowd/crowd_file.h"
#include "skinning/crowd/crowd_person.h"
#include "skinning/crowd/crowd_prototype.h"

#include <gtest/gtest.h>
#include <tiny_gltf.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>

#include "anatomy/errors.h"
#include "skinning/crowd/crowd_motion.h"
#include "skinning/crowd/crowd_read.h"
#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

std::string bytes_of_crowd(const fs::path& file) {
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
  out.vertex_count = character.body.skin.V.rows();
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
    write_crowd_person(file, prototype, character, weights_of(character).joint_weights);
    return {character.body.name, file, {{"stature_m", 1.7}}, {{"sex", "female"}}};
  }

  fs::path folder = fs::temp_directory_path() / ("crowd-" + std::to_string(getpid()));
  Character pattern = person("pattern", 1);
  CrowdPrototype prototype = make_crowd_prototype(pattern);
};

// What a player of glTF makes of a file.
class PlayedCrowd {
 public:
  explicit PlayedCrowd(const fs::path& file) {
    std::string error, warning;
    tinygltf::TinyGLTF loader;
    const bool ok = file.extension() == ".glb"
                        ? loader.LoadBinaryFromFile(&model_, &error, &warning, file)
                        : loader.LoadASCIIFromFile(&model_, &error, &warning, file);
    EXPECT_TRUE(ok) << error;
  }
  const tinygltf::Model& model() const { return model_; }
  const tinygltf::Node& node(const std::string& name) const {
    for (const tinygltf::Node& node : model_.nodes)
      if (node.name == name) return node;
    throw std::runtime_error(name);
  }
  // Every channel's last key.
  void play_to_end(const std::string& motion) {
    for (const tinygltf::Animation& animation : model_.animations) {
      if (animation.name != motion) continue;
      for (const tinygltf::AnimationChannel& channel : animation.channels) {
        const tinygltf::AnimationSampler& sampler = animation.samplers[channel.sampler];
        tinygltf::Node& node = model_.nodes[channel.target_node];
        const std::size_t last = model_.accessors[sampler.output].count - 1;
        EXPECT_EQ(model_.accessors[sampler.input].count, last + 1);
        if (channel.target_path == "rotation") {
          std::int16_t q[4]{};
          std::memcpy(q, at(sampler.output, last), sizeof q);
          node.rotation = {q[0] / 32767.0, q[1] / 32767.0, q[2] / 32767.0, q[3] / 32767.0};
        } else {
          node.translation.clear();
          for (std::size_t k = 0; k < 3; ++k) {
            float t = 0;
            std::memcpy(&t, at(sampler.output, last) + k * sizeof t, sizeof t);
            node.translation.push_back(double(t));
          }
        }
      }
    }
  }
  // When the motion of a joint, the first of a person, begins and ends.
  std::pair<double, double> times_of(const std::string& motion, int node) const {
    for (const tinygltf::Animation& animation : model_.animations)
      for (const tinygltf::AnimationChannel& channel : animation.channels)
        if (animation.name == motion && channel.target_node == node) {
          const tinygltf::Accessor& times =
              model_.accessors[animation.samplers[channel.sampler].input];
          return {times.minValues.at(0), times.maxValues.at(0)};
        }
    throw std::runtime_error(motion);
  }
  const tinygltf::Primitive& primitive(const std::string& name) const {
    return model_.meshes[node(name).mesh].primitives[0];
  }

  // A skinned mesh as its nodes stand, world.
  Points rest(const std::string& name) const {
    const tinygltf::Primitive& p = primitive(name);
    const tinygltf::Skin& skin = model_.skins[node(name).skin];
    std::vector<Eigen::Matrix4d> matrices;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      Eigen::Matrix4f inverse;
      std::memcpy(inverse.data(), at(skin.inverseBindMatrices, j), sizeof inverse);
      Eigen::Matrix4d world = Eigen::Matrix4d::Identity();
      for (int n = skin.joints[j]; n >= 0; n = parent(n))
        world = matrix_of(model_.nodes[n]) * world;
      matrices.push_back(world * inverse.cast<double>());
    }
    const auto count = model_.accessors[p.attributes.at("POSITION")].count;
    Points out(count, 3);
    for (std::size_t v = 0; v < count; ++v) {
      std::int16_t q[3];
      std::uint8_t joints[4];
      std::uint16_t weights[4];
      std::memcpy(q, at(p.attributes.at("POSITION"), v), sizeof q);
      std::memcpy(joints, at(p.attributes.at("JOINTS_0"), v), sizeof joints);
      std::memcpy(weights, at(p.attributes.at("WEIGHTS_0"), v), sizeof weights);
      EXPECT_EQ(weights[0] + weights[1] + weights[2] + weights[3], 65535);
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      for (int k = 0; k < 4; ++k)
        sum += weights[k] / 65535.0 *
               (matrices[joints[k]] *
                Eigen::Vector4d(q[0] / 32767.0, q[1] / 32767.0, q[2] / 32767.0, 1));
      out.row(v) = sum.head<3>();
    }
    return out;
  }

 private:
  static Eigen::Matrix4d matrix_of(const tinygltf::Node& node) {
    Eigen::Matrix4d out = Eigen::Matrix4d::Identity();
    if (const auto& q = node.rotation; !q.empty())
      out.topLeftCorner<3, 3>() = Quat(q[3], q[0], q[1], q[2]).toRotationMatrix();
    for (std::size_t k = 0; k < node.scale.size(); ++k) out.col(k) *= node.scale[k];
    for (std::size_t k = 0; k < node.translation.size(); ++k) out(k, 3) = node.translation[k];
    return out;
  }
  int parent(int child) const {
    for (std::size_t n = 0; n < model_.nodes.size(); ++n)
      for (int c : model_.nodes[n].children)
        if (c == child) return int(n);
    return -1;
  }
  const unsigned char* at(int accessor, std::size_t i) const {
    const tinygltf::Accessor& a = model_.accessors[accessor];
    const tinygltf::BufferView& view = model_.bufferViews[a.bufferView];
    return model_.buffers[view.buffer].data.data() + view.byteOffset +
           i * std::size_t(a.ByteStride(view));
  }
  tinygltf::Model model_;
};

TEST_F(CrowdTest, PeopleStandAsTheyWereInBothKindsOfFile) {
  const Character tall = person("tall", 1.1), small = person("small", 0.8);
  const std::vector<CrowdMember> members{member(small), member(tall)};
  for (const char* name : {"crowd.glb", "crowd.gltf"}) {
    write_crowd(folder / name, prototype, members);
    const PlayedCrowd crowd(folder / name);
    const auto apart = [&](const char* who) { return crowd.node(who).translation; };
    for (const Character* one : {&small, &tall}) {
      const std::string& who = one->body.name;
      const auto& t = apart(who.c_str());
      Points asked = one->body.skin.V, read = crowd.rest(who + "/skin");
      ASSERT_EQ(read.rows(), asked.rows());
      read.rowwise() -= Eigen::RowVector3d(t[0], t[1], t[2]);
      EXPECT_LT((read - asked).cwiseAbs().maxCoeff(), 4e-5) << name << " " << who;
      const Points bone = one->anatomy.bones[1].mesh.V;
      const Points bones =
          crowd.rest(who + "/bones").rowwise() - Eigen::RowVector3d(t[0], t[1], t[2]);
      const CrowdPrototype::Part& part = prototype.layers[1].parts[1];
      EXPECT_EQ(part.name, one->anatomy.bones[1].name);
      ASSERT_EQ(part.vertex_end - part.vertex_begin, bone.rows());
      EXPECT_LT((bones.middleRows(part.vertex_begin, bone.rows()) - bone).cwiseAbs().maxCoeff(),
                4e-5);
      const Points muscles =
          crowd.rest(who + "/muscles").rowwise() - Eigen::RowVector3d(t[0], t[1], t[2]);
      const double scale = one == &small ? 0.8 : 1.1;
      for (Eigen::Index v = 0; v < muscles.rows(); ++v)
        ASSERT_LT((muscles.row(v) / scale - Eigen::RowVector3d(0.2, 1.25, 0)).norm(), 0.25);
      EXPECT_EQ(crowd.node(who).extras.Get("sex").Get<std::string>(), "female");
      EXPECT_DOUBLE_EQ(crowd.node(who).extras.Get("stature_m").GetNumberAsDouble(), 1.7);
    }
    EXPECT_GT(std::abs(apart("tall")[0] - apart("small")[0]) +
                  std::abs(apart("tall")[2] - apart("small")[2]),
              1.0);
  }
}

TEST_F(CrowdTest, WhatPeopleHaveInCommonIsThereOnce) {
  std::vector<CrowdMember> members;
  for (int i = 0; i < 4; ++i)
    members.push_back(member(person("p" + std::to_string(i), 0.9 + 0.05 * i)));
  write_crowd(folder / "four.glb", prototype, members);
  write_crowd(folder / "one.glb", prototype, {members[0]});
  const PlayedCrowd crowd(folder / "four.glb");
  for (const char* layer : {"skin", "bones", "muscles"}) {
    const bool own_weights = std::string(layer) == "skin";
    std::set<int> shared, own;
    for (const CrowdMember& m : members) {
      const tinygltf::Primitive& p = crowd.primitive(m.name + "/" + layer);
      shared.insert(p.indices);
      (own_weights ? own : shared)
          .insert({p.attributes.at("JOINTS_0"), p.attributes.at("WEIGHTS_0")});
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
  write_crowd(folder / "first.glb", prototype, {a, b});
  const std::string before = bytes_of_crowd(b.file);
  fs::remove(a.file), fs::remove(b.file);
  member(person("b", 0.9)), member(person("a", 1.0));
  EXPECT_EQ(bytes_of_crowd(b.file), before);
  write_crowd(folder / "second.glb", prototype, {a, b});
  EXPECT_EQ(bytes_of_crowd(folder / "first.glb"), bytes_of_crowd(folder / "second.glb"));
}

TEST_F(CrowdTest, WhatDoesNotBelongIsRefused) {
  Character other = person("other", 1);
  other.body.skin = test::make_arm(1, true, 40).skin;
  EXPECT_THROW(
      write_crowd_person(folder / "other.bin", prototype, other, weights_of(other).joint_weights),
      UnfitError);
  EXPECT_FALSE(fs::exists(folder / "other.bin"));
  CrowdMember a = member(person("a", 1));
  EXPECT_THROW(write_crowd(folder / "twice.glb", prototype, {a, a}), UsageError);
  EXPECT_THROW(write_crowd(folder / "crowd.obj", prototype, {a}), UsageError);
  std::ofstream(a.file, std::ios::app) << "more";
  EXPECT_THROW(write_crowd(folder / "long.glb", prototype, {a}), InputError);
  fs::remove(a.file);
  EXPECT_THROW(write_crowd(folder / "gone.glb", prototype, {a}), InputError);
  EXPECT_FALSE(fs::exists(folder / "long.glb") || fs::exists(folder / "gone.glb"));
}

std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST_F(CrowdTest, APersonComesBack) {
  const Character giant = person("giant", 2.5),
                  small = person("small", 0.8);  // one beyond what metres hold
  const std::vector<CrowdMember> members{member(giant), member(small)};
  for (const char* name : {"crowd.glb", "crowd.gltf"}) {
    write_crowd(folder / name, prototype, members);
    const Crowd crowd = open_crowd(folder / name);
    EXPECT_EQ(crowd.people, (std::vector<std::string>{"giant", "small"}));
    for (const Character* one : {&giant, &small}) {
      const CrowdPerson back = read_crowd_person(crowd, one->body.name);
      EXPECT_LT((back.body.skin.V - one->body.skin.V).cwiseAbs().maxCoeff(),
                one == &giant ? 6e-5 : 2e-5);
      EXPECT_EQ(back.body.skin.F, one->body.skin.F);
      EXPECT_EQ(back.body.sex, Sex::female);
      const std::vector<Joint>&found = back.skeleton.joints, &asked = one->anatomy.skeleton.joints;
      ASSERT_EQ(found.size(), asked.size());
      for (std::size_t j = 0; j < asked.size(); ++j) {
        EXPECT_EQ(found[j].name, asked[j].name);
        EXPECT_EQ(found[j].parent, asked[j].parent);
        EXPECT_LT((found[j].X_PJ.translation() - asked[j].X_PJ.translation()).norm(), 1e-6);
        EXPECT_LT((found[j].axes - asked[j].axes).norm() + (found[j].zero - asked[j].zero).norm(),
                  1e-6);
        EXPECT_LT((found[j].min - asked[j].min).norm() + (found[j].max - asked[j].max).norm(),
                  1e-6);
      }
      const auto address = crowd_address((folder / name).string() + "#" + one->body.name);
      ASSERT_TRUE(address);
      EXPECT_EQ(read_crowd_person(open_crowd(address->file), address->person).body.skin.V,
                back.body.skin.V);
    }
  }
}

TEST_F(CrowdTest, WhoIsNotNamedOrNotThereIsToldWhoIs) {
  write_crowd(folder / "crowd.glb", prototype,
              {member(person("ada", 1)), member(person("bob", 1))});
  const std::string file = (folder / "crowd.glb").string();
  EXPECT_NE(error_of([&] { crowd_address(file); }).find("crowd.glb#ada (ada, bob)"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              read_crowd_person(open_crowd(file), "eve");
            }).find("nobody is named 'eve'; there are ada, bob"),
            std::string::npos);
  EXPECT_NE(error_of([&] { refuse_crowd(file + "#ada"); }).find("ecorche fit"), std::string::npos);
  EXPECT_NE(error_of([&] { refuse_crowd(file); }).find("name one of them"), std::string::npos);
  EXPECT_FALSE(is_crowd(folder / "ada.bin"));
  EXPECT_FALSE(crowd_address(folder / "none.glb#ada"));
}

TEST_F(CrowdTest, DamagedCrowdsAreRefused) {
  write_crowd(folder / "crowd.glb", prototype, {member(person("ada", 1))});
  write_crowd(folder / "crowd.gltf", prototype, {member(person("ada", 1))});
  const std::string whole = bytes_of_crowd(folder / "crowd.glb"),
                    text = bytes_of_crowd(folder / "crowd.gltf");
  const auto put = [&](const char* name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
  };
  const auto refused = [&](const char* name, const char* says = "") {
    const std::string why = error_of([&] { read_crowd_person(open_crowd(folder / name), "ada"); });
    EXPECT_NE(why.find(name), std::string::npos) << why;
    EXPECT_NE(why.find(says), std::string::npos) << why;
  };
  for (const std::size_t kept :
       {std::size_t{10}, std::size_t{300}, whole.size() / 2, whole.size() - 1}) {
    put("short.glb", whole.substr(0, kept));
    refused("short.glb");
  }
  const auto changed = [&](const std::string& from, const std::string& to, const char* says = "") {
    std::string out = text;
    const auto at = out.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    out.replace(at, from.size(), to);
    put("changed.gltf", out);
    refused("changed.gltf", says);
  };
  changed("\"ada.bin\"", "\"../" + folder.filename().string() +
                             "/ada.bin\"");  // there, but nothing outside the folder is opened
  changed("\"ada.bin\"", "\"bob.bin\"");
  changed("\"schema\":2", "\"schema\":3");
  changed("\"joint_frames\":", "\"joint_frames\":99999", "reach beyond");
  changed("\"inverseBindMatrices\":", "\"inverseBindMatrices\":1");
  changed("\"children\":[1]", "\"children\":[0]", "above the joints");
  changed("\"children\":[1]", "\"children\":[99999]", "children that are none");
  changed("\"POSITION\":", "\"POSITION\":7");
  changed("\"count\":", "\"count\":-");
}

// Joints turn by `angle` at the end, and the figure walks off.
Motion test_motion(const Skeleton& skeleton, double angle) {
  Motion out{10, {rest_pose(skeleton), rest_pose(skeleton), rest_pose(skeleton)}};
  for (std::size_t f = 1; f < 3; ++f) {
    out.frames[f].root += Vec3(0.1, 0.02, 0.3) * double(f);
    out.frames[f].rotations[3] = Quat(Eigen::AngleAxisd(-angle * double(f) / 2, Vec3::UnitX()));
  }
  return out;
}

TEST_F(CrowdTest, AllMoveEachByTheirOwnMotion) {
  const Character giant = person("giant", 2.5), small = person("small", 0.8);
  for (const char* name : {"crowd.glb", "crowd.gltf"}) {
    write_crowd(folder / name, prototype, {member(giant), member(small)});
    const auto angle = [](const std::string& who) { return who == "giant" ? 0.5 : 1.2; };
    write_crowd_motion(
        folder / "moving.glb", open_crowd(folder / name), {"bend", 0.5},
        [&](const CrowdPerson& one) { return test_motion(one.skeleton, angle(one.body.name)); });
    PlayedCrowd moving(folder / "moving.glb");
    moving.play_to_end("bend");
    for (const Character* one : {&giant, &small}) {
      const std::string& who = one->body.name;
      const Skeleton& skeleton = one->anatomy.skeleton;
      const Motion motion = test_motion(skeleton, angle(who));
      std::vector<Transform> posed;
      forward_kinematics(skeleton, motion.frames.back(), posed);
      const std::vector<Vec3> rest = rest_positions(skeleton);
      const Binding weights = weights_of(*one);
      const auto& t = moving.node(who).translation;
      const Points found =
          moving.rest(who + "/skin").rowwise() - Eigen::RowVector3d(t[0], t[1], t[2]);
      double most = 0;
      for (Eigen::Index v = 0; v < found.rows(); ++v) {
        Vec3 asked = Vec3::Zero();
        for (const Influence& i : weights.joint_weights[v])
          asked +=
              i.weight * (posed[i.joint] * (one->body.skin.V.row(v).transpose() - rest[i.joint]));
        most = std::max(most, (asked - found.row(v).transpose()).norm());
      }
      EXPECT_LT(most, 2e-4) << who;  // turns are good to 0.004 degrees
      const auto [begin, end] =
          moving.times_of("bend", moving.model().skins[one == &giant ? 0 : 1].joints[0]);
      EXPECT_NEAR(begin, one == &giant ? 0 : 0.5, 1e-6);
      EXPECT_NEAR(end - begin, 0.2, 1e-6);
    }
    // Another motion may follow, the same name may not.
    const auto move = [](const CrowdPerson& one) { return test_motion(one.skeleton, 1); };
    write_crowd_motion(folder / "twice.glb", open_crowd(folder / "moving.glb"), {"again"}, move);
    EXPECT_EQ(PlayedCrowd(folder / "twice.glb").model().animations.size(), 2u);
    EXPECT_THROW(write_crowd_motion(folder / "thrice.glb", open_crowd(folder / "moving.glb"),
                                    {"bend"}, move),
                 UsageError);
    EXPECT_THROW(write_crowd_motion(folder / "thrice.glb", open_crowd(folder / "moving.glb"),
                                    {"other"}, [](const CrowdPerson&) { return Motion{}; }),
                 std::invalid_argument);
    EXPECT_FALSE(fs::exists(folder / "thrice.glb"));
  }
}

TEST_F(CrowdTest, SkinsAlone) {
  prototype = make_crowd_prototype(pattern, CrowdLayers::skin_alone);
  const Character ada = person("ada", 0.9);
  write_crowd(folder / "skins.glb", prototype, {member(ada)});
  const PlayedCrowd crowd(folder / "skins.glb");
  EXPECT_EQ(crowd.model().meshes.size(), 1u);
  EXPECT_EQ(crowd.model().materials.size(), 1u);
  EXPECT_LT((crowd.rest("ada/skin") - ada.body.skin.V).cwiseAbs().maxCoeff(), 4e-5);
  EXPECT_EQ(read_crowd_person(open_crowd(folder / "skins.glb"), "ada").skeleton.joints.size(),
            pattern.anatomy.skeleton.joints.size());
}

TEST_F(CrowdTest, NobodyReachesIntoANeighbour) {
  write_crowd(folder / "crowd.glb", prototype,
              {member(person("a", 20)), member(person("b", 20)), member(person("c", 20)),
               member(person("d", 20))});
  const PlayedCrowd crowd(folder / "crowd.glb");
  std::vector<std::pair<Vec3, Vec3>> boxes;
  for (const char* who : {"a", "b", "c", "d"}) {
    const Points skin = crowd.rest(std::string(who) + "/skin");
    boxes.emplace_back(skin.colwise().minCoeff(), skin.colwise().maxCoeff());
  }
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_TRUE((boxes[i].first.array() > boxes[k].second.array()).any() ||
                  (boxes[k].first.array() > boxes[i].second.array()).any())
          << i << " " << k;
}

}  // namespace
}  // namespace ecorche
