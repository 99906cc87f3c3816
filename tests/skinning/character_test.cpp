// A character comes back from its file as it went in; damaged files are refused, never trusted.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <limits>

#include "anatomy/character.h"
#include "anatomy/errors.h"
#include "anatomy/muscles/action_line.h"
#include "skinning/files/character_read.h"
#include "skinning/files/character_write.h"
#include "skinning/files/light_character.h"

using namespace ecorche;
namespace fs = std::filesystem;

namespace {

TriMesh box(const Vec3& low, const Vec3& high) {
  TriMesh mesh;
  mesh.V.resize(8, 3);
  for (int i = 0; i < 8; ++i)
    mesh.V.row(i) << (i & 1 ? high : low).x(), (i & 2 ? high : low).y(), (i & 4 ? high : low).z();
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4,
      6, 1, 3, 5, 3, 7, 5;
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
  path[1].placing_joint = 1;
  path[2].joints = {1, -1};
  std::vector<Station> stations(5);
  for (int k = 0; k < 5; ++k)
    stations[k] = {0.25 * k, Vec3::Zero(), Vec3::UnitZ(), Vec2(0.01 + 0.004 * k, 0.008)};
  muscle.strips.push_back(make_strip(path, stations));
  Wrap wrap;
  wrap.kind = Wrap::Kind::cylinder;
  wrap.joint = 1;
  wrap.radii = Vec3(0.01, 0.01, 0.03);
  wrap.X_WO.translation() = Vec3(0.3, 1.4, 0);
  muscle.strips[0].wraps.push_back(wrap);
  muscle.strips[0].slices[3].outline[5] = 0.8f;
  character.anatomy.muscles.push_back(muscle);
  FasciaSheet sheet;
  sheet.name = "cover";
  sheet.side = Side::left;
  sheet.label = "a cover";
  sheet.group = "arm";
  sheet.rows = 2;
  sheet.columns = 3;
  sheet.V.resize(6, 3);
  sheet.V << 0.15, 1.46, -0.01, 0.15, 1.465, 0, 0.15, 1.46, 0.01, 0.25, 1.46, -0.01, 0.25, 1.465, 0,
      0.25, 1.46, 0.01;
  sheet.belly = {0, 0.5f, 1, 0, 0.5f, 1};
  sheet.bones = {"humerus"};
  character.anatomy.fascia.push_back(sheet);
  character.body.name = "arm";
  character.body.sex = Sex::female;
  character.body.mass = 3.5;
  character.body.skin = box(Vec3(-0.05, 1.3, -0.1), Vec3(0.65, 1.5, 0.1));
  character.body.landmarks.push_back({"elbow_tip", Vec3(0.3, 1.38, -0.02)});
  return character;
}

Binding binding_of(const Character& character) {
  Binding binding;
  binding.vertex_count = character.body.skin.V.rows();
  Anchor anchor;
  anchor.kind = Anchor::Kind::bone;
  anchor.part = 0;
  anchor.distance = 0.03;
  binding.anchors.assign(binding.vertex_count, anchor);
  binding.joint_weights.assign(binding.vertex_count, {Influence{0, 0.25}, Influence{1, 0.75}});
  return binding;
}

// A texture whose seam runs round the box's upper face: its four vertices lie elsewhere on the
// sides.
CharacterLook seamed_look(const Character& character) {
  const Triangles& F = character.body.skin.F;
  CharacterLook look;
  for (int i = 0; i < 8; ++i) look.texture.vertex.push_back(i);
  look.texture.F = F;
  for (const int v : {4, 5, 6, 7}) {  // faces 2 and 3 are the upper one
    const int copy = look.texture.vertex.size();
    look.texture.vertex.push_back(v);
    for (int f = 2; f < 4; ++f)
      for (int k = 0; k < 3; ++k)
        if (F(f, k) == v) look.texture.F(f, k) = copy;
  }
  look.texture.places = TexturePoints::Random(12, 2);
  look.eyes = {{Vec3(0.1, 1.5, 0), 0.012, 0}, {Vec3(-0.1, 1.5, 0), 0.012, 0}};
  return look;
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

void write_bytes(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

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
  for (std::size_t k = 0; k < a.strips[0].path.size(); ++k)
    EXPECT_EQ(b.strips[0].path[k].placing_joint, a.strips[0].path[k].placing_joint);
  ASSERT_EQ(b.strips[0].slices.size(), 5u);
  EXPECT_EQ(b.strips[0].slices[3].radii, a.strips[0].slices[3].radii);
  EXPECT_EQ(b.strips[0].slices[3].roll, a.strips[0].slices[3].roll);
  EXPECT_EQ(b.strips[0].slices[3].outline, a.strips[0].slices[3].outline);
  EXPECT_NE(b.strips[0].slices[3].outline, kEllipticOutline);
  EXPECT_EQ(b.strips[0].slices[2].outline, kEllipticOutline);
  ASSERT_EQ(b.strips[0].wraps.size(), 1u);
  EXPECT_EQ(b.strips[0].wraps[0].kind, Wrap::Kind::cylinder);
  EXPECT_TRUE(b.strips[0].wraps[0].X_WO.isApprox(a.strips[0].wraps[0].X_WO));

  ASSERT_EQ(out.anatomy.fascia.size(), 1u);
  const FasciaSheet &sheet = in.anatomy.fascia[0], &read = out.anatomy.fascia[0];
  EXPECT_EQ(read.name, sheet.name);
  EXPECT_EQ(read.side, sheet.side);
  EXPECT_EQ(read.label, sheet.label);
  EXPECT_EQ(read.group, sheet.group);
  EXPECT_EQ(read.rows, 2);
  EXPECT_EQ(read.columns, 3);
  EXPECT_LT((read.V - sheet.V).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(read.belly, sheet.belly);
  EXPECT_EQ(read.bones, sheet.bones);

  EXPECT_EQ(out.body.name, "arm");
  EXPECT_EQ(out.body.sex, Sex::female);
  EXPECT_EQ(out.body.mass, 3.5);
  EXPECT_LT((out.body.skin.V - in.body.skin.V).cwiseAbs().maxCoeff(), 1e-6);
  ASSERT_EQ(out.body.landmarks.size(), 1u);
  EXPECT_EQ(out.body.landmarks[0].position, in.body.landmarks[0].position);
}

// Files of before seams and tissues read as ever.
TEST(Character, AnEarlierSchemaIsRead) {
  const Character in = arm(), out = read_character(fs::path(ECORCHE_TEST_DIR) / "corpus" /
                                                   "character" / "schema1.glb");
  EXPECT_EQ(out.body.skin.F, in.body.skin.F);
  ASSERT_EQ(out.anatomy.bones.size(), 2u);
  EXPECT_EQ(out.anatomy.bones[1].mesh.F, in.anatomy.bones[1].mesh.F);
  EXPECT_EQ(out.anatomy.muscles[0].strips[0].slices[3].outline,
            in.anatomy.muscles[0].strips[0].slices[3].outline);
}

TEST(Character, SeamsOfTheTextureAreSplitAndJoinedAgain) {
  const Folder folder;
  const Character in = arm();
  write_character(folder.path / "a.glb", in, binding_of(in), nullptr, seamed_look(in));
  const std::string text = bytes_of(folder.path / "a.glb");
  for (const char* wanted :
       {"TEXCOORD_0", "_SKIN_VERTEX", "COLOR_0", "eye/left", "eye/right", "eye_white"})
    EXPECT_NE(text.find(wanted), std::string::npos) << wanted;
  const Body out = read_character(folder.path / "a.glb").body;
  EXPECT_EQ(out.skin.F, in.body.skin.F);
  EXPECT_LT((out.skin.V - in.body.skin.V).cwiseAbs().maxCoeff(), 1e-6);
  CharacterLook other = seamed_look(in);
  other.texture.F.conservativeResize(5, 3);
  EXPECT_THROW(write_character(folder.path / "b.glb", in, binding_of(in), nullptr, other),
               std::invalid_argument);
}

TEST(Character, DamagedSeamsAreRefused) {
  const Folder folder;
  const Character in = arm();
  write_character(folder.path / "a.glb", in, binding_of(in), nullptr, seamed_look(in));
  const std::string whole = bytes_of(folder.path / "a.glb");
  // The copies' own vertices, 4 5 6 7 after 0 .. 7, as floats.
  std::string names;
  for (const float v : {0.f, 1.f, 2.f, 3.f, 4.f, 5.f, 6.f, 7.f, 4.f, 5.f, 6.f, 7.f})
    names.append(reinterpret_cast<const char*>(&v), 4);
  const size_t at = whole.find(names);
  ASSERT_NE(at, std::string::npos);
  for (const float bad : {-1.f, 8.f, 4.5f, 1e30f, std::numeric_limits<float>::quiet_NaN()}) {
    std::string bytes = whole;
    bytes.replace(at + 4 * 9, 4, reinterpret_cast<const char*>(&bad), 4);
    write_bytes(folder.path / "bad.glb", bytes);
    EXPECT_THROW(read_character(folder.path / "bad.glb"), InputError) << bad;
  }
}

TEST(Character, ALightFileIsForLookingAtOnly) {
  const Folder folder;
  const Character in = arm();
  const Motion motion = wave(in.anatomy.skeleton);
  write_light_character(folder.path / "a.glb", in, binding_of(in), kLowDetail, &motion,
                        seamed_look(in));
  try {
    read_character(folder.path / "a.glb");
    ADD_FAILURE() << "it was read";
  } catch (const UnfitError& error) {
    EXPECT_NE(std::string(error.what()).find("light"), std::string::npos) << error.what();
  }
  EXPECT_EQ(read_body(folder.path / "a.glb").skin.F, in.body.skin.F);
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
  EXPECT_THROW(read_character(folder.path / "body.glb"), UnfitError);
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
  const std::pair<const char*, const char*> damages[] = {{"\"schema\":2", "\"schema\":9"},
                                                         {"\"count\":8", "\"count\":9999999"},
                                                         {"\"joint\":1", "\"joint\":7"},
                                                         {"\"axes\":[", "\"axos\":["},
                                                         {"\"side\":\"left\"", "\"side\":\"lift\""},
                                                         {"\"path\":[[", "\"path\":[[\"x\","},
                                                         {"\"columns\":3", "\"columns\":4"},
                                                         {"\"rows\":2", "\"rows\":-2"},
                                                         {"\"rows\":2", "\"rows\":2000000"},
                                                         {"\"_BELLY\"", "\"_BELLS\""},
                                                         {"[\"humerus\"]", "[\"nobody\"]"}};
  for (const auto& [from, to] : damages) {
    std::string bytes = whole;
    const size_t at = bytes.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    bytes.replace(at, std::string(from).size(), to);
    // Keep the chunk and file lengths true, so that only the value is wrong.
    const int grown = int(std::string(to).size()) - int(std::string(from).size());
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
  EXPECT_THROW(write_character(folder.path / "a.glb", character, binding_of(character), &motion),
               std::invalid_argument);
  EXPECT_FALSE(fs::exists(folder.path / "a.glb"));
}
