// The studio's skeleton: a tail, a finger that is missing, scaled bones, a joint between two
// others; what would break the anatomy is refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "anatomy/errors.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "app/edit/edited_skeleton.h"
#include "app/edit/project.h"
#include "app/edit/refit.h"
#include "app/edit/session.h"
#include "app/studio/design/axis_handles.h"
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

}  // namespace
}  // namespace ecorche
