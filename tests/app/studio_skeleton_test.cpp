// The studio's skeleton: a tail, a finger that is missing, scaled bones, a joint between two
// others; what would break the anatomy is refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "anatomy/errors.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "app/edit/document/edited_skeleton.h"
#include "app/edit/project.h"
#include "app/edit/refit.h"
#include "app/edit/session.h"
#include "app/studio/handles/axis_handles.h"
#include "app/studio/handles/dropped_bone.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

#define NEED_BONES()                              \
  if (!fs::exists(test_assets().packages.folder)) \
  GTEST_SKIP() << "no data packages: data/setup.sh --packages fetches them"

// A tetrahedron that hangs down by 80 mm, in mm.
constexpr const char* kTail =
    "v 0 0 0\nv 8 -80 0\nv -8 -80 0\nv 0 -80 8\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

class StudioSkeleton : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("skeleton." + std::to_string(getpid()));
    fs::create_directories(folder_);
    std::ofstream(folder_ / "tail.obj") << kTail;
    common_.assets = test_assets();
    common_.quiet = true;
  }
  void TearDown() override { fs::remove_all(folder_); }

  Session session() { return Session(common_, report_, {}); }
  void make_tail(Session& s) {
    s.run_line("add_joint tail pelvis at=coccyx+0,-4,-4 to=coccyx+0,-60,-60");
    s.run_line("add_bone tail_bone tail unit=mm file=" + (folder_ / "tail.obj").string());
  }
  FittedCharacter fit(Session& s) {
    FittingOptions options = fitting_of(s.document());
    options.dilated = false;
    return fit_character(edited_template(s.workshop(), s.document()), s.workshop().base().body,
                         s.workshop().package(), options);
  }
  std::string why(Session& s, const std::string& line) {
    const std::string before = document_text(s.document());
    std::string said;
    try {
      s.run_line(line);
    } catch (const Error& error) {
      said = error.what();
    }
    EXPECT_NE(said, "") << line;
    EXPECT_EQ(document_text(s.document()), before) << line;
    return said;
  }

  fs::path folder_;
  Common common_;
  Report report_;
};

Vec3 centre(const Anatomy& anatomy, const std::string& joint) {
  const int found = find_joint(anatomy.skeleton, joint);
  EXPECT_GE(found, 0) << joint;
  return found < 0 ? Vec3::Zero() : rest_positions(anatomy.skeleton)[std::size_t(found)];
}

std::string parent_of(const Anatomy& anatomy, const std::string& joint) {
  const int found = find_joint(anatomy.skeleton, joint);
  const int parent = found < 0 ? -1 : anatomy.skeleton.joints[std::size_t(found)].parent;
  return parent < 0 ? "" : anatomy.skeleton.joints[std::size_t(parent)].name;
}

TEST_F(StudioSkeleton, ABodyIsFittedWithATailWithoutAFingerAndWithAShorterThigh) {
  NEED_BONES();
  Session s = session();
  const FittedCharacter before = fit(s);
  make_tail(s);
  s.run_line("add_joint lumbar_6 l5 at=sac_s1+0,30,40 child=l4");
  s.run_line("remove_joint mcp5 muscles=remove");
  s.run_line("set_group femur length=0.96");
  s.run_line("new_muscle tail_lifter from=sac_s2 to=tail_bone+0,-60,0 volume=10ml");
  const FittedCharacter made = fit(s);
  ASSERT_NO_THROW(validate(made.anatomy));
  const Anatomy &a = before.anatomy, &b = made.anatomy;

  EXPECT_EQ(parent_of(b, "tail"), "pelvis");
  const int bone = find_bone(b, "tail_bone");
  ASSERT_GE(bone, 0);
  EXPECT_EQ(b.skeleton.joints[std::size_t(b.bones[std::size_t(bone)].joint)].name, "tail");
  // its first vertex is the mesh's origin, which the joint's centre carries
  EXPECT_LT((b.bones[std::size_t(bone)].mesh.V.row(0).transpose() - centre(b, "tail")).norm(),
            3e-3);
  const int lifter = find_muscle(b, "tail_lifter_l");
  ASSERT_GE(lifter, 0);
  const int end = b.muscles[std::size_t(lifter)].strips[0].path.back().joints[0];
  EXPECT_EQ(b.skeleton.joints[std::size_t(end)].name, "tail");

  EXPECT_EQ(parent_of(b, "lumbar_6"), "l5");
  EXPECT_EQ(parent_of(b, "l4"), "lumbar_6");
  EXPECT_EQ(parent_of(b, "l3"), "l4");
  EXPECT_LT((centre(a, "l4") - centre(b, "l4")).norm(), 1e-9);

  for (const Bone& each : b.bones)
    for (const char* gone : {"mcp5_l", "pip5_r", "dip5_l"})
      EXPECT_NE(b.skeleton.joints[std::size_t(each.joint)].name, gone) << each.name;
  EXPECT_LT(find_bone(b, "distal_phalanx5_r"), 0);
  EXPECT_GE(find_bone(b, "metacarpal5_r"), 0);
  EXPECT_EQ(b.bones.size() + 6, a.bones.size() + 1);
  EXPECT_LT(find_muscle(b, "abductor_digiti_minimi_hand_l"), 0);

  // The thigh is shorter, what hangs on it goes along, what lies before it stays; but for what the
  // skin presses on bones that come near to it.
  const double thigh = (centre(a, "knee_l") - centre(a, "hip_l")).norm();
  EXPECT_NEAR((centre(b, "knee_l") - centre(b, "hip_l")).norm(), 0.96 * thigh, 0.01 * thigh);
  for (const char* side : {"_l", "_r"}) {
    const std::string knee = std::string("knee") + side, ankle = std::string("ankle") + side;
    EXPECT_LT(((centre(b, ankle) - centre(b, knee)) - (centre(a, ankle) - centre(a, knee))).norm(),
              4e-3);
  }
  EXPECT_LT((centre(a, "hip_l") - centre(b, "hip_l")).norm(), 2e-3);
  EXPECT_LT((centre(a, "wrist_l") - centre(b, "wrist_l")).norm(), 1e-9);
}

TEST_F(StudioSkeleton, AProjectHoldsItAndReadsBackTheSame) {
  NEED_BONES();
  Session s = session();
  make_tail(s);
  for (const char* line :
       {"set_bone tail_bone by=1,2,3.5 turn=10,0,-4 scale=1.25",
        "add_joint tail_2 tail at=tail_bone",
        "add_joint wing thorax at=coccyx+60,300,-40 paired=yes", "remove_joint mcp5 muscles=remove",
        "set_limits tail flexion min=-20 max=70", "turn_axes wing flexion=12", "snap_joint knee",
        "set_group thorax width=1.07 tuck=3", "move_joint tail by=0,-2,0",
        "new_wrap tail_roll sphere at=tail_bone+0,-10,0 radius=9",
        "new_muscle tail_lifter from=sac_s2 to=tail_bone@-25,850,-260 volume=10ml",
        "use_wrap tail_lifter wrap=tail_roll"})
    ASSERT_NO_THROW(s.run_line(line)) << line;
  s.run(Save{(folder_ / "project").string()});
  EXPECT_TRUE(fs::exists(folder_ / "project" / "bones" / "tail_bone.obj"));
  const Document again = read_project(s.workshop(), folder_ / "project").document;
  EXPECT_EQ(document_text(again), document_text(s.document()));
  s.run(Undo{1000});
  s.run(Save{});
  EXPECT_TRUE(fs::is_empty(folder_ / "project" / "bones"));
  EXPECT_EQ(document_text(s.document()), document_text(s.workshop().built_in()));
}

TEST_F(StudioSkeleton, WhatWouldBreakTheAnatomyIsRefusedWithTheNextStep) {
  NEED_BONES();
  Session s = session();
  make_tail(s);
  s.run_line("new_muscle tail_lifter from=sac_s2 to=tail_bone volume=10ml");
  const auto says = [&](const std::string& line, std::initializer_list<const char*> parts) {
    const std::string said = why(s, line);
    for (const char* part : parts) EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  says("remove_joint knee", {"'knee'", "every body has it"});
  says("remove_joint mcp5", {"muscles hang on it", "muscles=remove"});
  says("remove_joint tail", {"tail_bone", "remove_bone"});
  says("remove_bone tail_bone", {"tail_lifter"});
  says("remove_bone femur", {"'femur'"});
  says("add_joint tail pelvis at=coccyx", {"there is one of that name"});
  says("add_joint elbow pelvis at=coccyx", {"there is one of that name"});
  says("add_joint fin pelvsi at=coccyx", {"'parent'", "pelvis"});
  says("add_joint fin pelvis at=coccix", {"coccix", "coccyx"});
  says("add_joint fin l5 at=coccyx child=l3", {"'child': 'l3'", "'l4'"});
  says("add_joint fin elbow at=coccyx paired=no", {"two sides", "fin_l"});
  says("set_group femr length=1.1", {"femr", "femur"});
  says("set_group femur", {"length=1.05"});
  says("set_group femur length=3", {"length", "2"});
  says("snap_joint tail", {"the skin does not say"});
  says("add_bone spike tail file=none.obj", {"none.obj"});
  says("add_bone spike tail file=" + (folder_ / "tail.obj").string(), {"80 m large", "unit=mm"});
  says("restore_joint mcp5", {"not taken away"});
  s.run_line("remove_joint mcp5 muscles=remove");
  says("turn_joint pip5 flexion=20", {"'pip5'"});
}

TEST_F(StudioSkeleton, ACentreSnapsToWhereTheSkinHasIt) {
  NEED_BONES();
  Session s = session();
  s.run_line("move_joint knee by=9,9,9");
  s.run_line("snap_joint knee");
  const Template edited = edited_template(s.workshop(), s.document());
  const FitTables& tables = s.workshop().base().tables;
  const NamedPoints centres =
      joint_centres(tables.regressor, edited.body.skin.V.topRows(tables.topology.skin_size));
  EXPECT_LT((centre(edited.anatomy, "knee_l") - centres.at("knee")).norm(), 2e-5);
}

// The end of an axis goes where the hand takes it, on either side, whatever was turned before.
TEST_F(StudioSkeleton, AnAxisThatIsDraggedPointsToWhereTheHandIs) {
  NEED_BONES();
  Session s = session();
  s.run_line("turn_axes elbow flexion=5 abduction=-8 rotation=3");
  const Template edited = edited_template(s.workshop(), s.document());
  const Skeleton& skeleton = edited.anatomy.skeleton;
  PosedAnatomy posed;
  forward_kinematics(skeleton, rest_pose(skeleton), posed.X_WJ);
  const BoneCarrier carrier(s.workshop().base().anatomy, edited.anatomy);
  const Document shown = s.document();
  for (const char* name : {"elbow_l", "elbow_r"}) {
    std::vector<Handle> handles;
    add_axes(skeleton, shown, s.document(), find_joint(skeleton, name), posed, handles);
    ASSERT_EQ(handles.size(), 3u);
    for (const Handle& handle : handles) {
      const Vec3 moved(4e-3, -3e-3, 5e-3);
      const auto action = action_of_axis({s.document(), s.workshop(), carrier, posed, skeleton},
                                         handle, moved, false);
      ASSERT_TRUE(action);
      const Document after = *applied(s.workshop(), s.document(), *action);
      std::vector<Handle> turned;
      add_axes(skeleton, shown, after, find_joint(skeleton, name), posed, turned);
      const Vec3 to = turned[std::size_t(handle.axis)].place - handle.middle;
      const Vec3 wanted = handle.place + moved - handle.middle;
      EXPECT_LT(to.normalized().cross(wanted.normalized()).norm(), 4e-3) << name << handle.axis;
      EXPECT_GT(to.dot(wanted), 0);
    }
  }
}

// A bone of 16 x 80 x 8 mm, in mm, as the formats that people have bones in.
void write_tails(const fs::path& folder) {
  const TriMesh mesh = read_mesh(folder / "tail.obj");
  write_ply(folder / "tail.ply", mesh);
  std::ofstream stl(folder / "tail.stl", std::ios::binary);
  stl.write(std::string(80, ' ').data(), 80);
  const auto put = [&](const auto& value) {
    stl.write(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(std::uint32_t(mesh.F.rows()));
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) put(0.0f);
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < 3; ++c) put(float(mesh.V(mesh.F(f, k), c)));
    put(std::uint16_t(0));
  }
  std::ofstream(folder / "tail.off") << "OFF\n4 4 0\n0 0 0\n8 -80 0\n-8 -80 0\n0 -80 8\n"
                                        "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  // in metres, as the format has it, under a node that moves it by 1 m and back
  std::string bytes;
  const auto add = [&](auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (Eigen::Index v = 0; v < 4; ++v)
    for (int c = 0; c < 3; ++c) add(float(1e-3 * mesh.V(v, c) - (c == 0 ? 1 : 0)));
  for (Eigen::Index f = 0; f < 4; ++f)
    for (int k = 0; k < 3; ++k) add(std::uint32_t(mesh.F(f, k)));
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
      R"("nodes":[{"mesh":0,"translation":[1,0,0]}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)"
      R"("min":[-1.008,-0.08,0],"max":[-0.992,0,0.008]},)"
      R"({"bufferView":1,"componentType":5125,"count":12,"type":"SCALAR"}],)"
      R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},)"
      R"({"buffer":0,"byteOffset":48,"byteLength":48}],"buffers":[{"byteLength":96}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::ofstream glb(folder / "tail.glb", std::ios::binary);
  const auto word = [&](std::uint32_t value) {
    glb.write(reinterpret_cast<const char*>(&value), 4);
  };
  glb << "glTF";
  word(2), word(std::uint32_t(12 + 8 + json.size() + 8 + bytes.size()));
  word(std::uint32_t(json.size())), glb << "JSON" << json;
  word(std::uint32_t(bytes.size())), glb << "BIN" << '\0' << bytes;
}

TEST_F(StudioSkeleton, ABoneOfEveryFormatIsTheSameByScriptAndByDrop) {
  NEED_BONES();
  write_tails(folder_);
  const std::vector<std::string> taken{"tail", "tail_2"};
  std::string text;
  {
    Session s = session();
    for (const std::string kind : {"obj", "ply", "stl", "off", "glb"}) {
      const fs::path file = folder_ / ("tail." + kind);
      s.run_line("add_bone of_" + kind + " pelvis " + std::string(kind == "glb" ? "" : "unit=mm ") +
                 "file=" + file.string());
      const TriMesh by_script =
          placed_bone(s.workshop(), s.document(), s.document().skeleton->bones.back());
      const TriMesh& bone = *s.document().skeleton->bones.back().mesh;
      const Vec3 low = bone.V.colwise().minCoeff(), high = bone.V.colwise().maxCoeff();
      EXPECT_LT((low - Vec3(-0.008, -0.08, 0)).norm(), 1e-6) << kind << low.transpose();
      EXPECT_LT((high - Vec3(0.008, 0, 0.008)).norm(), 1e-6) << kind << high.transpose();
      EXPECT_EQ(bone.F.rows(), 4) << kind;

      DroppedBone dropped = dropped_bone(file, read_mesh_file(file), taken);
      EXPECT_EQ(dropped.name, "tail_3");
      EXPECT_EQ(dropped.unit, kind == "glb" ? "m" : "mm");
      EXPECT_FALSE(dropped.centred);
      dropped.name = "dropped_" + kind;
      s.run_line(line_of(dropped, "pelvis"));
      const TriMesh by_drop =
          placed_bone(s.workshop(), s.document(), s.document().skeleton->bones.back());
      EXPECT_LT((by_drop.V - by_script.V).cwiseAbs().maxCoeff(), 1e-9) << kind;
    }
    s.run_line("save " + (folder_ / "kept").string());
    text = document_text(s.document());
  }
  Session again(common_, report_, {folder_ / "kept"});
  EXPECT_EQ(document_text(again.document()), text);
}

TEST_F(StudioSkeleton, ADroppedBoneFarFromItsOriginComesToTheJoint) {
  NEED_BONES();
  std::ofstream(folder_ / "My Bone-7.obj")
      << "v 900 400 100\nv 908 320 100\nv 892 320 100\nv 900 320 108\nf 1 3 2\nf 1 2 4\n"
         "f 1 4 3\nf 2 3 4\n";
  const fs::path file = folder_ / "My Bone-7.obj";
  const DroppedBone dropped = dropped_bone(file, read_mesh_file(file), {});
  EXPECT_EQ(dropped.name, "my_bone_7");
  EXPECT_TRUE(dropped.centred);
  Session s = session();
  s.run_line(line_of(dropped, "pelvis"));
  const TriMesh placed = placed_bone(s.workshop(), s.document(), s.document().skeleton->bones[0]);
  const Vec3 middle = 0.5 * (placed.V.colwise().minCoeff() + placed.V.colwise().maxCoeff());
  const Skeleton& skeleton = s.workshop().source().skeleton;
  const Vec3 pelvis = rest_positions(skeleton)[std::size_t(find_joint(skeleton, "pelvis"))];
  EXPECT_LT((middle - pelvis).norm(), 2e-4);
}

TEST_F(StudioSkeleton, AFingerThatWasTakenAwayIsListedNoMore) {
  NEED_BONES();
  Session s = session();
  const auto lists = [&](const char* joint) {
    const auto names = joint_names(s.workshop(), s.document());
    return std::ranges::find(names, joint) != names.end();
  };
  EXPECT_TRUE(lists("mcp5") && lists("dip5"));
  s.run_line("remove_joint mcp5 muscles=remove");
  EXPECT_FALSE(lists("mcp5") || lists("pip5") || lists("dip5"));
  EXPECT_TRUE(lists("mcp4"));
}

}  // namespace
}  // namespace ecorche
