// A stranger's own animation, by our bones and muscles: it comes out as its own joints and weights
// have it, whatever pose it stands in.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/mesh_files/glb_bytes.h"
#include "anatomy/mesh_files/gltf_file.h"
#include "app/files/actor.h"
#include "app/files/open_motion.h"
#include "app/files/stranger.h"
#include "skinning/rigs/own_motion.h"
#include "tests/app/stranger.h"
#include "tests/body_fixture.h"
#include "tests/morph/built_template.h"

namespace ecorche {
namespace {

constexpr int kFrames = 13;  // at 12 fps, a second

// A fighter's stance: turned trunk, head aside, fists up, legs apart and bent.
Registration in_stance(const BodyPackage& package) {
  return test::turned_package(package, [](const std::string& name) -> Quat {
    const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
    if (name.ends_with("Spine")) return test::turn_about(25, y) * test::turn_about(15, x);
    if (name.ends_with("Head")) return test::turn_about(-40, y);
    if (name.ends_with("LeftArm")) return test::turn_about(-35, z) * test::turn_about(-40, y);
    if (name.ends_with("LeftForeArm")) return test::turn_about(-60, y);
    if (name.ends_with("RightArm")) return test::turn_about(40, z) * test::turn_about(30, y);
    if (name.ends_with("RightForeArm")) return test::turn_about(70, y);
    if (name.ends_with("LeftUpLeg")) return test::turn_about(-35, x) * test::turn_about(15, z);
    if (name.ends_with("RightUpLeg")) return test::turn_about(-15, x) * test::turn_about(-20, z);
    if (name.ends_with("LeftLeg") || name.ends_with("RightLeg")) return test::turn_about(40, x);
    return Quat::Identity();
  });
}

// How far a joint of the stranger has turned at the end, world axes.
Vec3 whole_turn(const std::string& name) {
  if (name.ends_with("Hips")) return {0, 0.5, 0};
  if (name.ends_with("Spine1")) return {0.25, 0, 0.1};
  if (name.ends_with("Head")) return {0.1, 0.4, 0};
  if (name.ends_with("LeftArm")) return {0, -0.3, 0.4};
  if (name.ends_with("RightForeArm")) return {0, -0.5, 0};
  if (name.ends_with("LeftUpLeg")) return {-0.4, 0, 0};
  if (name.ends_with("RightLeg")) return {0.3, 0, 0};
  return Vec3::Zero();
}
const Vec3 kWay(0.3, 0.05, 0.4);  // of the hips in the world, m

Quat turn_at(const std::string& name, double t) {
  const Vec3 turn = t * whole_turn(name);
  return turn.norm() > 0 ? Quat(Eigen::AngleAxisd(turn.norm(), turn.normalized()))
                         : Quat::Identity();
}

// The stranger's file with an animation of its joints, whose axes are the file's as it stands.
// `standing_turn`: by which an arm is turned where no animation plays.
std::string with_animation(const std::string& glb, const Registration& registration,
                           double standing_turn = 0) {
  const GlbParts parts = split_glb(glb, "stranger");
  auto root = nlohmann::ordered_json::parse(parts.json);
  std::string binary(parts.binary);
  const auto add = [&](const std::vector<float>& values, const char* type, std::size_t columns) {
    binary.resize((binary.size() + 3) / 4 * 4);
    root["bufferViews"].push_back({{"buffer", 0},
                                   {"byteOffset", binary.size()},
                                   {"byteLength", values.size() * sizeof(float)}});
    binary.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", 5126},
                                 {"count", values.size() / columns},
                                 {"type", type}});
    return root["accessors"].size() - 1;
  };
  std::vector<float> times;
  for (int f = 0; f < kFrames; ++f) times.push_back(float(f) / float(kFrames - 1));
  const std::size_t input = add(times, "SCALAR", 1);
  nlohmann::ordered_json take{{"name", "spar"}};
  const auto add_channel = [&](std::size_t node, const char* path, std::size_t output) {
    take["samplers"].push_back({{"input", input}, {"output", output}});
    take["channels"].push_back(
        {{"sampler", take["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
  };
  const Mat3 to_file = registration.axes.transpose();
  for (const auto& joint : root["skins"][0]["joints"]) {
    auto& node = root["nodes"][joint.get<std::size_t>()];
    const std::string name = node["name"];
    std::vector<float> turns, places;
    for (const float t : times) {
      const Quat q(to_file * turn_at(name, t).toRotationMatrix() * to_file.transpose());
      turns.insert(turns.end(), {float(q.x()), float(q.y()), float(q.z()), float(q.w())});
      const Vec3 way = to_file * kWay * (double(t) / registration.scale);
      for (int k = 0; k < 3; ++k)
        places.push_back(node["translation"][std::size_t(k)].get<float>() + float(way[k]));
    }
    add_channel(joint, "rotation", add(turns, "VEC4", 4));
    if (name.ends_with("Hips")) add_channel(joint, "translation", add(places, "VEC3", 3));
    if (name.ends_with("LeftArm") && standing_turn != 0)
      node["rotation"] = {std::sin(standing_turn / 2), 0, 0, std::cos(standing_turn / 2)};
  }
  root["animations"] = {take};
  root["buffers"][0]["byteLength"] = (binary.size() + 3) / 4 * 4;
  return glb_bytes(root.dump(), binary);
}

// The stranger's mesh by its own joints and weights, world.
Points moved_by_itself(const SourceRig& rig, const Registration& registration, double t) {
  const auto world = [&](const Vec3& p) -> Vec3 {
    return registration.scale * registration.axes * p + registration.shift;
  };
  std::vector<Transform> moves;
  for (const SourceJoint& joint : rig.joints) {
    const Vec3 place = world(joint.X_W.translation());
    Transform move = Transform::Identity();
    if (joint.name.ends_with("Hips")) move.translate(t * kWay);
    move.translate(place).rotate(turn_at(joint.name, t)).translate(-place);
    moves.push_back(joint.parent < 0 ? move : moves[std::size_t(joint.parent)] * move);
  }
  Points out(rig.mesh.V.rows(), 3);
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const Vec3 p = world(rig.mesh.V.row(i));
    Vec3 sum = Vec3::Zero();
    for (const Influence& w : rig.weights[std::size_t(i)])
      sum += w.weight * (moves[std::size_t(w.joint)] * p);
    out.row(i) = sum;
  }
  return out;
}

class OwnMotionTest : public BodyFixture {
 protected:
  void SetUp() override {
    BodyFixture::SetUp();
    if (IsSkipped()) return;
    NEED_TEMPLATE();
    file = std::filesystem::temp_directory_path() / "ecorche_own_motion_test.glb";
    if (stranger.source) return;  // once for all tests
    registration = in_stance(package());
    stranger = make_stranger(test::stranger_glb(package(), registration), "stranger.glb");
    Report aside;
    FittedForFile fitted = fit_stranger(test_assets(), tmpl, stranger, registration, package(),
                                        {.fitting = {.tissues = false}}, aside);
    actor = make_actor(test_assets(), std::move(fitted.bound.character), aside);
  }
  void TearDown() override { std::filesystem::remove(file); }

  std::optional<OwnMotion> own(const std::string& glb) const {
    return own_motion(glb, "own", {}, *actor.character.own, actor.character.anatomy.skeleton,
                      actor.character.body.skin.V, actor.binding.joint_weights);
  }

  static inline Registration registration;
  static inline Stranger stranger;
  static inline Actor actor;
  std::filesystem::path file;
};

TEST_F(OwnMotionTest, ComesOutAsItsOwnJointsHaveIt) {
  std::ofstream(file, std::ios::binary) << with_animation(*stranger.source, registration);
  Report report;
  Common common;
  common.quiet = true;
  const Motion motion = open_motion(file, actor, {}, common, report);
  EXPECT_NE(report.to_json().find("\"own_rig\": true"), std::string::npos);
  ASSERT_EQ(motion.frames.size(), std::size_t(kFrames));
  ActorState state(actor);
  const int body = stranger.rig.pieces[0].vertex_count;
  for (const int f : {0, 6, 12}) {
    Points ours;
    to_points(evaluate_skin(actor, motion.frames[std::size_t(f)], {}, state), ours);
    const Points theirs = moved_by_itself(stranger.rig, registration, double(f) / (kFrames - 1));
    std::vector<double> miss;
    for (int i = 0; i < body; ++i) miss.push_back((ours.row(i) - theirs.row(i)).norm());
    std::sort(miss.begin(), miss.end());
    double sum = 0;
    for (const double m : miss) sum += m;
    RecordProperty("mean_mm_" + std::to_string(f), std::to_string(1e3 * sum / body));
    EXPECT_LT(sum / body, 0.008) << f;
    EXPECT_LT(miss[std::size_t(0.95 * body)], 0.025) << f;
  }
}

TEST_F(OwnMotionTest, WhereItStandsItStandsAgain) {
  const auto motion = own(with_animation(*stranger.source, registration));
  ASSERT_TRUE(motion);
  const Pose &first = motion->motion.frames[0], &standing = actor.character.own->pose;
  EXPECT_LT((first.root - standing.root).norm(), 0.003);
  for (std::size_t j = 0; j < first.rotations.size(); ++j)
    if (!actor.character.anatomy.skeleton.joints[j].name.starts_with("patella")) {
      EXPECT_LT(first.rotations[j].angularDistance(standing.rotations[j]), 5 * kDegree)
          << actor.character.anatomy.skeleton.joints[j].name;
    }
}

TEST_F(OwnMotionTest, AnotherFileOfTheSameSkeletonMayStandOtherwise) {
  const auto here = own(with_animation(*stranger.source, registration)),
             there = own(with_animation(*stranger.source, registration, 1.0));
  ASSERT_TRUE(here && there);
  for (std::size_t f = 0; f < here->motion.frames.size(); ++f)
    for (std::size_t j = 0; j < here->motion.frames[f].rotations.size(); ++j)
      EXPECT_LT(
          here->motion.frames[f].rotations[j].angularDistance(there->motion.frames[f].rotations[j]),
          1e-6);
}

TEST_F(OwnMotionTest, AnotherSkeletonIsAnother) {
  const std::string glb = with_animation(*stranger.source, registration);
  const auto changed = [&](const auto& change) {
    const GlbParts parts = split_glb(glb, "stranger");
    auto root = nlohmann::ordered_json::parse(parts.json);
    for (auto& node : root["nodes"])
      if (std::string(node["name"]).ends_with("LeftForeArm")) change(node);
    return glb_bytes(root.dump(), std::string(parts.binary));
  };
  EXPECT_TRUE(own(changed([](auto&) {})));
  EXPECT_FALSE(own(changed([](auto& node) { node["name"] = "Other"; })));
  EXPECT_FALSE(own(changed([](auto& node) {
    for (auto& x : node["translation"]) x = 1.2 * x.template get<double>();
  })));
}

}  // namespace
}  // namespace ecorche
