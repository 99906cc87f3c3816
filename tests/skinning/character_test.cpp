// A character comes back from its file as it went in; damaged files are refused, never trusted.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "anatomy/errors.h"
#include "anatomy/muscle_line.h"
#include "skinning/character_io.h"

using namespace ecorche;
namespace fs = std::filesystem;

namespace {

TriMesh box(const Vec3& low, const Vec3& high) {
  TriMesh mesh;
  mesh.V.resize(8, 3);
  for (int i = 0; i < 8; ++i)
    mesh.V.row(i) << (i & 1 ? high : low).x(), (i & 2 ? high : low).y(), (i & 4 ? high : low).z();
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5;
  return mesh;
}

Character arm() {
  Character character;
  Skeleton& skeleton = character.anatomy.skeleton;
  for (int j = 0; j < 2; ++j) {
    Joint joint;
    joint.name = j == 0 ? "shoulder" : "elbow";
    joint.parent = j - 1;
    joint.X_PJ.translation() = Vec3(0.3 * j, j == 0 ? 1.4 : 0, 0);
    joint.min = Vec3(-1, -2, -3);
    joint.max = Vec3(1, 2, 3);
    skeleton.joints.push_back(joint);
    Bone bone;
    bone.name = j == 0 ? "humerus" : "ulna";
    bone.joint = j;
    bone.side = Side::left;
    bone.mesh = box(Vec3(0.3 * j, 1.39, -0.01), Vec3(0.3 * j + 0.3, 1.41, 0.01));
    character.anatomy.bones.push_back(bone);
  }
  Muscle muscle;
  muscle.name = "brachialis";
  muscle.label = "brachialis \"<&>\"";
  muscle.volume = 1e-4;
  std::vector<PathPoint> path(3);
  path[0].rest = Vec3(0.1, 1.42, 0);
  path[1].rest = Vec3(0.28, 1.45, 0);
  path[2].rest = Vec3(0.35, 1.42, 0);
  path[1].joints = {0, 1};
  path[1].share = 0.7;
  path[2].joints = {1, -1};
  std::vector<Station> stations(5);
  for (int k = 0; k < 5; ++k) stations[k] = {0.25 * k, Vec3::Zero(), Vec3::UnitZ(), Vec2(0.01 + 0.004 * k, 0.008)};
  muscle.strips.push_back(make_strip(path, stations));
  Wrap wrap;
  wrap.kind = Wrap::Kind::cylinder;
  wrap.joint = 1;
  wrap.radii = Vec3(0.01, 0.01, 0.03);
  wrap.X_WO.translation() = Vec3(0.3, 1.4, 0);
  muscle.strips[0].wraps.push_back(wrap);
  muscle.strips[0].slices[3].outline[5] = 0.8f;
  character.anatomy.muscles.push_back(muscle);
  character.body.name = "arm";
  character.body.sex = Sex::female;
  character.body.mass = 3.5;
  character.body.skin = box(Vec3(-0.05, 1.3, -0.1), Vec3(0.65, 1.5, 0.1));
  character.body.landmarks.push_back({"elbow_tip", Vec3(0.3, 1.38, -0.02)});
  return character;
}

Binding binding_of(const Character& character) {
  Binding binding;
  binding.vertex_count = static_cast<int>(character.body.skin.V.rows());
  Anchor anchor;
  anchor.kind = Anchor::Kind::bone;
  anchor.part = 0;
  anchor.distance = 0.03;
  binding.anchors.assign(binding.vertex_count, anchor);
  binding.joint_weights.assign(binding.vertex_count, {Influence{0, 0.25}, Influence{1, 0.75}});
  return binding;
}

struct Folder {
  fs::path path = fs::temp_directory_path() / ("ecorche-character-" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

Motion wave(const Skeleton& skeleton) {
  Motion motion;
  motion.fps = 24;
  for (int f = 0; f < 10; ++f) {
    motion.frames.push_back(rest_pose(skeleton));
    motion.frames.back().rotations[1] = Quat(Eigen::AngleAxisd(0.1 * f, Vec3::UnitZ()));
  }
  return motion;
}

}  // namespace

TEST(Character, ComesBackAsItWentIn) {
  const Folder folder;
  const Character in = arm();
  const Motion motion = wave(in.anatomy.skeleton);
  write_character(folder.path / "a.glb", in, binding_of(in), &motion);
  const Character out = read_character(folder.path / "a.glb");

  ASSERT_EQ(out.anatomy.skeleton.joints.size(), 2u);
  for (int j = 0; j < 2; ++j) {
    const Joint &a = in.anatomy.skeleton.joints[j], &b = out.anatomy.skeleton.joints[j];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.parent, b.parent);
    EXPECT_EQ(a.X_PJ.translation(), b.X_PJ.translation());
    EXPECT_EQ(a.axes, b.axes);
    EXPECT_EQ(a.max, b.max);
  }
  ASSERT_EQ(out.anatomy.bones.size(), 2u);
  EXPECT_EQ(out.anatomy.bones[1].name, "ulna");
  EXPECT_EQ(out.anatomy.bones[1].side, Side::left);
  EXPECT_LT((out.anatomy.bones[1].mesh.V - in.anatomy.bones[1].mesh.V).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(out.anatomy.bones[1].mesh.F, in.anatomy.bones[1].mesh.F);

  ASSERT_EQ(out.anatomy.muscles.size(), 1u);
  const Muscle &a = in.anatomy.muscles[0], &b = out.anatomy.muscles[0];
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.volume, b.volume);
  ASSERT_EQ(b.strips.size(), 1u);
  ASSERT_EQ(b.strips[0].path.size(), 3u);
  EXPECT_EQ(b.strips[0].path[1].rest, a.strips[0].path[1].rest);
  EXPECT_EQ(b.strips[0].path[1].joints, a.strips[0].path[1].joints);
  EXPECT_EQ(b.strips[0].path[1].share, a.strips[0].path[1].share);
  ASSERT_EQ(b.strips[0].slices.size(), 5u);
  EXPECT_EQ(b.strips[0].slices[3].radii, a.strips[0].slices[3].radii);
  EXPECT_EQ(b.strips[0].slices[3].roll, a.strips[0].slices[3].roll);
  EXPECT_EQ(b.strips[0].slices[3].outline, a.strips[0].slices[3].outline);
  EXPECT_NE(b.strips[0].slices[3].outline, kEllipticOutline);
  EXPECT_EQ(b.strips[0].slices[2].outline, kEllipticOutline);
  ASSERT_EQ(b.strips[0].wraps.size(), 1u);
  EXPECT_EQ(b.strips[0].wraps[0].kind, Wrap::Kind::cylinder);
  EXPECT_TRUE(b.strips[0].wraps[0].X_WO.isApprox(a.strips[0].wraps[0].X_WO));

  EXPECT_EQ(out.body.name, "arm");
  EXPECT_EQ(out.body.sex, Sex::female);
  EXPECT_EQ(out.body.mass, 3.5);
  EXPECT_LT((out.body.skin.V - in.body.skin.V).cwiseAbs().maxCoeff(), 1e-6);
  ASSERT_EQ(out.body.landmarks.size(), 1u);
  EXPECT_EQ(out.body.landmarks[0].position, in.body.landmarks[0].position);
}

TEST(Character, SameInputSameBytes) {
  const Folder folder;
  const Character character = arm();
  write_character(folder.path / "a.glb", character, binding_of(character));
  write_character(folder.path / "b.glb", character, binding_of(character));
  EXPECT_EQ(bytes_of(folder.path / "a.glb"), bytes_of(folder.path / "b.glb"));
}

TEST(Character, ABodyAloneComesBackToo) {
  const Folder folder;
  const Body body = arm().body;
  write_body(folder.path / "body.glb", body);
  EXPECT_TRUE(has_body_notes(folder.path / "body.glb"));
  EXPECT_EQ(read_body(folder.path / "body.glb").name, "arm");
  EXPECT_THROW(read_character(folder.path / "body.glb"), InputError);
}

TEST(Character, TruncatedFilesAreRefused) {
  const Folder folder;
  const Character character = arm();
  write_character(folder.path / "a.glb", character, binding_of(character));
  const std::string whole = bytes_of(folder.path / "a.glb");
  for (size_t length = 0; length < whole.size(); length += 1 + whole.size() / 97) {
    write_bytes(folder.path / "cut.glb", whole.substr(0, length));
    EXPECT_THROW(read_character(folder.path / "cut.glb"), Error) << length;
  }
}

TEST(Character, DamagedTextIsRefusedOrHarmless) {
  const Folder folder;
  const Character character = arm();
  write_character(folder.path / "a.glb", character, binding_of(character));
  const std::string whole = bytes_of(folder.path / "a.glb");
  const std::pair<const char*, const char*> damages[] = {
      {"\"schema\":1", "\"schema\":9"}, {"\"count\":8", "\"count\":9999999"}, {"\"joint\":1", "\"joint\":7"},
      {"\"axes\":[", "\"axos\":["},     {"\"side\":\"left\"", "\"side\":\"lift\""}, {"\"path\":[[", "\"path\":[[\"x\","}};
  for (const auto& [from, to] : damages) {
    std::string bytes = whole;
    const size_t at = bytes.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    bytes.replace(at, std::string(from).size(), to);
    // Keep the chunk and file lengths true, so that only the value is wrong.
    const int grown = static_cast<int>(std::string(to).size()) - static_cast<int>(std::string(from).size());
    for (int offset : {8, 12}) {
      std::uint32_t length;
      std::memcpy(&length, bytes.data() + offset, 4);
      length += grown;
      std::memcpy(bytes.data() + offset, &length, 4);
    }
    write_bytes(folder.path / "bad.glb", bytes);
    EXPECT_THROW(read_character(folder.path / "bad.glb"), Error) << from;
  }
}

TEST(Character, ThingsThatAreNoFilesAreRefused) {
  const Folder folder;
  EXPECT_THROW(read_character(folder.path), InputError);
  EXPECT_THROW(read_character(folder.path / "none.glb"), InputError);
  write_bytes(folder.path / "empty.glb", "");
  EXPECT_THROW(read_character(folder.path / "empty.glb"), InputError);
  write_bytes(folder.path / "text.glb", "this is no glTF file, it is a sentence");
  EXPECT_THROW(read_character(folder.path / "text.glb"), InputError);
}

TEST(Character, AForeignMotionIsOurMistake) {
  const Folder folder;
  const Character character = arm();
  Motion motion = wave(character.anatomy.skeleton);
  motion.frames[3].rotations.pop_back();
  EXPECT_THROW(write_character(folder.path / "a.glb", character, binding_of(character), &motion), std::invalid_argument);
  EXPECT_FALSE(fs::exists(folder.path / "a.glb"));
}
