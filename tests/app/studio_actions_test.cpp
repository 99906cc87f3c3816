// The studio's actions: each by its line and by its value, undone to the first byte, saved and read
// again, and what is left of a session that was killed.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include "anatomy/authoring/muscle_text.h"
#include "anatomy/errors.h"
#include "anatomy/muscles/action_line.h"
#include "app/edit/document/edit_muscle.h"
#include "app/edit/project.h"
#include "app/edit/refit.h"
#include "app/edit/session.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

#define NEED_PACKAGES()                           \
  if (!fs::exists(test_assets().packages.folder)) \
  GTEST_SKIP() << "no data packages: data/setup.sh --packages fetches them"

class StudioActions : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("studio." + std::to_string(getpid()));
    fs::create_directories(folder_);
    common_.assets = test_assets();
    common_.quiet = true;
  }
  void TearDown() override { fs::remove_all(folder_); }

  Session session(const fs::path& project = {}) {
    return Session(common_, report_, {project, false});
  }
  fs::path file(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  fs::path folder_;
  Common common_;
  Report report_;
};

std::string why(const std::function<void()>& run) {
  try {
    run();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

// An edit by chance; some of them cannot be done.
constexpr std::size_t kOfMuscles = 20, kOfAll = 40;  // kinds of edits
std::string chance_line(std::mt19937& random, const Document& document,
                        std::size_t kinds = kOfMuscles) {
  const auto below = [&](std::size_t n) { return int(random() % n); };
  const auto name = [&] {
    std::string out = document.muscles[std::size_t(below(document.muscles.size()))]->left.name;
    const char* sides[] = {"", "", "", "_l", "_r"};
    return out + sides[below(5)];
  };
  const auto wrap = [&] {
    return document.frame->wraps[std::size_t(below(document.frame->wraps.size()))].name;
  };
  const std::string made = "made_" + std::to_string(below(40));
  const std::string share = "0." + std::to_string(below(10));
  switch (below(kinds)) {
    case 0:
      return "move_point " + name() + " point=2 by=1.25,-0.7,3";
    case 1:
      return "add_point " + name() + " at=asis+1,2,3 after=1";
    case 2:
      return "remove_point " + name() + " point=2";
    case 3:
      return "set_section " + name() + " at=" + share + " width=21.3 roll=12";
    case 4:
      return "remove_section " + name() + " at=" + share;
    case 5:
      return "scale_sections " + name() + " width=1.1 thickness=0.93 roll=-7";
    case 6:
      return "set_belly " + name() + " begin=0.11 end=0.87";
    case 7:
      return "add_strip " + name() + " by=4,0,1";
    case 8:
      return "remove_strip " + name() + " strip=1";
    case 9:
      return "use_wrap " + name() + " wrap=" + wrap();
    case 10:
      return "copy_muscle " + split_side(name()).first + " as=" + made;
    case 11:
      return "remove_muscle " + split_side(name()).first;
    case 12:
      return "rename_muscle " + split_side(name()).first + " as=" + made;
    case 13:
      return "mirror_muscle " + name() + " from=right";
    case 14:
      return "set_muscle " + name() + " volume=31.7 pennation=7 force=212.5";
    case 15:
      return "new_wrap " + made + " cylinder at=asis+3,1,1 radius=9 axis=0.3,1,0.2";
    case 16:
      return "set_wrap " + wrap() + " radius=13.5 by=0.4,0,0";
    case 17:
      return "remove_wrap " + wrap();
    case 18:
      return "activate " + split_side(name()).first + " value=" + share;
    case 19:
      return "move_joint elbow by=2,-1,0.5";
    case 20:
      return "turn_axes knee flexion=" + std::to_string(below(9) - 4);
    case 21:
      return "set_limits hip flexion min=" + std::to_string(-20 - below(9)) +
             " max=" + std::to_string(100 + below(30));
    case 22:
      return "reset_joint elbow";
    case 23:
      return "set_layer factor=1." + std::to_string(below(10));
    case 24:
      return "turn_joint knee_l flexion=" + std::to_string(below(120));
    case 25:
      return "pose rest";
    case 26:
      return "undo steps=" + std::to_string(1 + below(5));
    case 27:
      return "redo steps=" + std::to_string(1 + below(3));
    case 28:
      return "pick " + name();
    case 29:
      return "set_group " + std::string(below(2) ? "femur" : "thorax") + " length=0.9" +
             std::to_string(below(9)) + " bow_depth=" + std::to_string(below(9));
    case 30:
      return "add_joint " + made + " pelvis at=coccyx+0,-" + std::to_string(below(40)) + ",-9";
    case 31:
      return "remove_joint " + (below(2) ? made : "toe_dip" + std::to_string(1 + below(5)));
    case 32:
      return "snap_joint " + std::string(below(2) ? "hip" : "elbow");
    case 33:
      return "activate " + split_side(name()).first + " value=" + share + " at=0." +
             std::to_string(below(5)) + "s";
    case 34:
      return "relax " + std::string(below(2) ? "all" : split_side(name()).first);
    case 35:
      return "compare " + std::string(below(2) ? "saved how=wiped" : "linear_blend");
    case 36:
      return "set_layer factor=1." + std::to_string(below(10)) +
             (below(2) ? " site=abdominal" : " site=triceps");
    case 37:
      return "activate function:elbow_flexion value=" + share;
    case 38:
      return "pose " + std::string(below(2) ? "squat" : "rest");
    default:
      return "set_fit rays=" + std::to_string(8 + below(40)) + " alpha=0.37";
  }
}

int walk(Session& session, int tries, unsigned seed) {
  std::mt19937 random(seed);
  int refused = 0;
  for (int k = 0; k < tries; ++k) try {
      session.run_line(chance_line(random, session.document()));
    } catch (const InputError&) {
      ++refused;
    }
  return refused;
}

// Arguments of an example with files of the test's own.
std::string with_files(std::string line, const fs::path& folder) {
  for (const char* name : {"anna.glb", "walk.bvh", "soleus.txt", "my-arm", "arm.glb", "arm.png",
                           "tail.obj", "biceps.obj"})
    if (const auto at = line.find(name); at != std::string::npos)
      line.replace(at, std::string(name).size(), (folder / name).string());
  return line;
}

// A closed spindle, m, as an OBJ file.
std::string spindle_obj(const Vec3& from, const Vec3& to, double radius) {
  constexpr int kRings = 14, kAround = 20;
  const Vec3 along = (to - from).normalized(), side = along.unitOrthogonal(),
             other = along.cross(side);
  std::ostringstream out;
  const auto vertex = [&](const Vec3& v) {
    out << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
  };
  vertex(from);
  for (int k = 1; k < kRings; ++k)
    for (int i = 0; i < kAround; ++i) {
      const double s = double(k) / kRings, angle = 2 * M_PI * i / kAround;
      const double r = radius * std::sin(M_PI * s);
      vertex(from + s * (to - from) + r * (std::cos(angle) * side + std::sin(angle) * other));
    }
  vertex(to);
  const int last = 2 + (kRings - 1) * kAround;
  const auto at = [&](int k, int i) { return 2 + (k - 1) * kAround + i % kAround; };
  for (int i = 0; i < kAround; ++i) {
    out << "f 1 " << at(1, i + 1) << " " << at(1, i) << "\n";
    out << "f " << last << " " << at(kRings - 1, i) << " " << at(kRings - 1, i + 1) << "\n";
    for (int k = 1; k + 1 < kRings; ++k) {
      out << "f " << at(k, i) << " " << at(k, i + 1) << " " << at(k + 1, i) << "\n";
      out << "f " << at(k, i + 1) << " " << at(k + 1, i + 1) << " " << at(k + 1, i) << "\n";
    }
  }
  return out.str();
}

TEST_F(StudioActions, EachHasANameHelpAndAnExampleThatReads) {
  std::set<std::string> names;
  std::set<std::size_t> types;
  for (const ActionKind& kind : action_kinds()) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_TRUE(types.insert(kind.fresh.index()).second) << kind.name;
    EXPECT_GT(std::string(kind.help).size(), 10u) << kind.name;
    const auto action = read_action(std::string(kind.name) + " " + kind.example);
    ASSERT_TRUE(action) << kind.name;
    EXPECT_EQ(action->index(), kind.fresh.index()) << kind.name;
    EXPECT_EQ(action_line(*read_action(action_line(*action))), action_line(*action));
    for (const ArgumentInfo& each : arguments_of(kind))
      EXPECT_GT(each.help.size(), 5u) << kind.name << " " << each.key;
    EXPECT_NE(list_of_actions().find(std::string("\n  ") + kind.name + " "), std::string::npos);
  }
  EXPECT_EQ(types.size(), std::variant_size_v<Action>);
}

TEST_F(StudioActions, EachDoesTheSameByScriptAndByItsValue) {
  NEED_PACKAGES();
  // these fit and draw: the command line's test runs them
  const std::set<std::string> fits{"write_character", "write_template", "write_model",
                                   "render",          "film",           "report",
                                   "curves",          "check_bones"};
  Session by_script = session(), by_value = session();
  file("anna.glb", "");
  file("walk.bvh", "");
  file("tail.obj",
       "v 0 0 0\nv 9 -80 0\nv -9 -80 0\nv 0 -80 9\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  file("biceps.obj", spindle_obj(Vec3(0.16, 1.42, -0.18), Vec3(0.19, 1.16, -0.16), 0.018));
  by_script.run_line("export_muscle soleus " + (folder_ / "soleus.txt").string());
  for (const ActionKind& kind : action_kinds()) {
    if (fits.contains(kind.name)) continue;
    const std::string line = with_files(std::string(kind.name) + " " + kind.example, folder_);
    const std::string before = document_text(by_script.document());
    ASSERT_NO_THROW(by_script.run_script(file("one.txt", "# one\n" + line + "\n"))) << line;
    if (std::string(kind.name) != "save") {
      ASSERT_NO_THROW(by_value.run(*read_action(line))) << line;
    }
    EXPECT_EQ(document_text(by_script.document()), document_text(by_value.document())) << line;
    const bool stays = std::set<std::string>{"save", "export_muscle", "mirror_muscle",
                                             "free_measure", "reset_joint"}
                           .contains(kind.name);
    if (std::string(kind.name) == "reset_joint" || std::string(kind.name) == "free_measure")
      EXPECT_NE(document_text(by_script.document()), before) << line;
    else
      EXPECT_EQ(document_text(by_script.document()) == before, stays) << line;
  }
}

TEST_F(StudioActions, AWalkIsUndoneToTheFirstByteAndDoneAgainToTheLast) {
  Session s = session();
  const std::string first = document_text(s.document());
  const int refused = walk(s, 400, 7);
  EXPECT_LT(refused, 200);
  const std::string last = document_text(s.document());
  EXPECT_NE(first, last);
  const int steps = int(s.history().now);
  s.run(Undo{steps});
  EXPECT_EQ(document_text(s.document()), first);
  EXPECT_EQ(s.document(), s.workshop().built_in());  // shares all with it
  s.run(Redo{steps});
  EXPECT_EQ(document_text(s.document()), last);
}

// As many edits of all kinds as ECORCHE_WALK says. Whatever they are, a muscle that is listed can
// be placed or is refused with a reason, and all of it can be taken back.
TEST_F(StudioActions, EditsByChanceLeaveEveryMuscleInPlaceOrRefusedWithAReason) {
  NEED_PACKAGES();
  const char* wanted = std::getenv("ECORCHE_WALK");
  const int tries = wanted ? std::atoi(wanted) : 300;
  Session s = session();
  std::mt19937 random(20261127);
  int done = 0, placed = 0, not_placed = 0;
  for (int k = 0; k < tries; ++k) {
    const std::string line = chance_line(random, s.document(), kOfAll);
    SCOPED_TRACE(line);
    const std::vector<Shared<EditedMuscle>> before = s.document().muscles;
    try {
      s.run_line(line);
      ++done;
    } catch (const InputError& error) {
      ASSERT_NE(std::string(error.what()), "");
      ASSERT_EQ(s.document().muscles, before);
      continue;
    }
    const Document& now = s.document();
    for (std::size_t m = 0; m < now.muscles.size(); ++m) {
      if (std::ranges::find(before, now.muscles[m]) != before.end()) continue;
      try {
        for (const Muscle& muscle : placed_entry(s.workshop(), now, int(m)))
          for (const Strip& strip : muscle.strips)
            for (const Ellipse& section : rest_slices(strip))
              ASSERT_TRUE(section.center.allFinite() && section.radii.allFinite()) << muscle.name;
        ++placed;
      } catch (const InputError&) {
        ++not_placed;
      }
    }
  }
  EXPECT_GT(done, tries / 3);
  EXPECT_LT(20 * not_placed, placed);
  s.run(Undo{1000000});
  EXPECT_EQ(document_text(s.document()), document_text(s.workshop().built_in()));
}

TEST_F(StudioActions, AMusclesTextReadsBackToTheSameText) {
  const Document document = built_in_document(test_assets().tables);
  for (const auto& muscle : document.muscles) {
    const TableMuscle once = read_block(document, blocks_of(document, *muscle).left, "once");
    const std::string text = muscle_text(*document.frame, once);
    EXPECT_EQ(muscle_text(*document.frame, read_block(document, text, "twice")), text);
    EXPECT_EQ(once.strips.size(), muscle->left.strips.size());
    EXPECT_NEAR(once.volume_male, muscle->left.volume_male, 1e-10);
    EXPECT_EQ(once.sources, muscle->left.sources);
    for (std::size_t k = 0; k < once.strips.size(); ++k)
      for (std::size_t p = 0; p < once.strips[k].path.size(); ++p)
        EXPECT_LT((position(*document.frame, once.strips[k].path[p]) -
                   position(*document.frame, muscle->left.strips[k].path[p]))
                      .norm(),
                  2e-7)
            << once.name;
  }
}

TEST_F(StudioActions, AProjectReadsBackAsItWasSaved) {
  NEED_PACKAGES();
  Session s = session();
  walk(s, 150, 3);
  for (const char* line :
       {"move_joint elbow by=0.1,2,0.3", "set_limits elbow_l flexion min=1 max=141",
        "set_layer factor=1.4 site=abdominal", "activate soleus value=0.2 at=0.5",
        "activate soleus value=0.9 at=0.7s", "activate soleus value=0.4 at=0.75s from=0.7s",
        "activate nerve:femoral_nerve value=0.3", "compare dual_quaternion how=wiped share=0.31",
        "turn_axes knee rotation=3.3", "set_measure waist_girth 78.2cm", "set_layer 0.83",
        "pose squat", "turn_joint elbow flexion=33.3", "pick soleus_r"})
    s.run_line(line);
  s.run(Save{(folder_ / "project").string()});
  EXPECT_FALSE(s.unsaved());
  const Document again = read_project(s.workshop(), folder_ / "project").document;
  EXPECT_EQ(document_text(again), document_text(s.document()));
  // Muscles that are no longer its own go.
  s.run(Undo{1000});
  s.run(Save{});
  EXPECT_TRUE(fs::is_empty(folder_ / "project" / "muscles"));
  EXPECT_EQ(document_text(read_project(s.workshop(), folder_ / "project").document),
            document_text(s.workshop().built_in()));
}

TEST_F(StudioActions, NothingThatWasDoneIsLostWhenASessionIsKilled) {
  const fs::path project = folder_ / "killed";
  for (const int survives : {0, 1, 13, 40}) {
    fs::remove_all(project);
    Session whole = session();
    std::mt19937 random(11);
    const pid_t child = fork();
    if (child == 0) {
      Session s = session(project);
      while (int(s.history().now) < survives) try {
          s.run_line(chance_line(random, s.document()));
        } catch (const InputError&) {
        }
      // a line that is torn off in its midst
      const int journal = open((project / "journal.txt").c_str(), O_WRONLY | O_APPEND);
      if (write(journal, "move_point sol", 14) == 14) kill(getpid(), SIGKILL);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    while (int(whole.history().now) < survives) try {
        whole.run_line(chance_line(random, whole.document()));
      } catch (const InputError&) {
      }
    Session recovered = session(project);
    EXPECT_EQ(int(recovered.history().now), survives);
    EXPECT_EQ(document_text(recovered.document()), document_text(whole.document()));
  }
}

// Moves are steps from where a point is: one that was done twice would show.
TEST_F(StudioActions, ASessionThatIsKilledWhileItSavesIsWholeAndDoesNothingTwice) {
  NEED_PACKAGES();
  constexpr int most = 60;
  const auto line = [](int k) {
    return "move_point " + std::string(k % 2 ? "soleus" : "plantaris") + " point=2 by=0,0,0.5";
  };
  std::vector<std::string> texts;  // after so many moves
  {
    Session whole = session();
    texts.push_back(document_text(whole.document()));
    for (int k = 0; k < most; ++k) {
      whole.run_line(line(k));
      texts.push_back(document_text(whole.document()));
    }
  }
  std::mt19937 random(5);
  for (int round = 0; round < 6; ++round) {
    const fs::path project = folder_ / ("saving" + std::to_string(round));
    int told[2];
    ASSERT_EQ(pipe(told), 0);
    const pid_t child = fork();
    if (child == 0) {
      Session s = session(project);
      for (char k = 0; k < most; ++k) {
        s.run_line(line(k));
        if (write(told[1], &k, 1) != 1) _exit(1);
        s.run_line("save");
      }
      pause();
    }
    close(told[1]);
    char k = -1;
    const int wanted = 1 + int(random() % 5);
    while (k + 1 < wanted && read(told[0], &k, 1) == 1) {
    }
    usleep(random() % 30000);  // somewhere in a save, or between two
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    while (read(told[0], &k, 1) == 1) {
    }
    close(told[0]);
    std::string text;
    {
      Session recovered = session(project);
      text = document_text(recovered.document());
      EXPECT_TRUE(text == texts[std::size_t(k + 1)] || text == texts[std::size_t(k + 2)])
          << "killed after move " << int(k);
      recovered.run_line("save");
    }
    EXPECT_EQ(document_text(session(project).document()), text);
  }
}

// What a kill leaves between the files of a project: some new, the journal still there.
TEST_F(StudioActions, AProjectThatIsSavedInPartOpensAsItWas) {
  NEED_PACKAGES();
  const fs::path project = folder_ / "part";
  std::string text;
  {
    Session s = session(project);
    s.run_line("set_muscle soleus fibre=5");
    s.run_line("save");
    s.run_line("move_point soleus point=2 by=0,0,1");
    text = document_text(s.document());
  }
  // as save begins: the copy is there, and the journal says so; then the project's own files
  {
    Session copy = session();
    copy.run_line("set_muscle soleus fibre=5");
    copy.run_line("move_point soleus point=2 by=0,0,1");
    write_project(copy.workshop(), copy.document(), project / kAsideFolders[0]);
    std::ofstream(project / "journal.txt", std::ios::app) << "saves unsaved-1\n";
    std::ofstream(project / "project.txt") << "muscle muscles/not-yet-written.txt\n";
  }
  EXPECT_EQ(document_text(session(project).document()), text);
  Session again = session(project);
  EXPECT_TRUE(again.unsaved());
  again.run_line("save");
  EXPECT_FALSE(fs::exists(project / kAsideFolders[0]));
}

TEST_F(StudioActions, WhatIsUndonePastTheLastSaveIsNotLostEither) {
  NEED_PACKAGES();
  const fs::path project = folder_ / "past";
  std::string text;
  {
    Session s = session(project);
    for (const char* line :
         {"set_muscle soleus fibre=5", "set_muscle soleus fibre=6", "save", "set_layer 0.9",
          "undo 2", "redo", "undo 2", "set_layer 0.7", "set_layer 0.6", "undo"})
      s.run_line(line);
    text = document_text(s.document());
  }
  EXPECT_EQ(document_text(session(project).document()), text);
}

TEST_F(StudioActions, BothSidesGoTogetherUnlessOneIsNamed) {
  Session s = session();
  const auto soleus = [&]() -> const EditedMuscle& {
    return *s.document().muscles[std::size_t(find_entry(s.document(), "soleus"))];
  };
  s.run_line("set_muscle soleus fibre=5");
  EXPECT_FALSE(soleus().right);
  s.run_line("set_muscle soleus_r fibre=6");
  ASSERT_TRUE(soleus().right);
  EXPECT_DOUBLE_EQ(soleus().left.fibre_length, 0.05);
  EXPECT_DOUBLE_EQ(soleus().right->fibre_length, 0.06);
  s.run_line("set_muscle soleus fibre=7");
  EXPECT_FALSE(soleus().right);  // alike again
  s.run_line("set_muscle soleus_r fibre=6");
  s.run_line("mirror_muscle soleus from=right");
  EXPECT_FALSE(soleus().right);
  EXPECT_DOUBLE_EQ(soleus().left.fibre_length, 0.06);
}

TEST_F(StudioActions, AMuscleGoesToAnotherProjectWithItsWraps) {
  Session here = session(), there = session();
  here.run_line("new_wrap my_pulley sphere at=asis+0,-20,5 radius=12");
  here.run_line("new_muscle mine from=asis to=tibia_level_10 volume=60ml label=\"my own # one\"");
  here.run_line("use_wrap mine wrap=my_pulley");
  here.run_line("move_point mine_r point=1 by=0,2,0");
  const std::string file = (folder_ / "mine.txt").string();
  here.run_line("export_muscle mine " + file);
  there.run_line("import_muscle " + file);
  EXPECT_EQ(document_text(there.document()), document_text(here.document()));
}

TEST_F(StudioActions, APointSnapsOntoABone) {
  NEED_PACKAGES();
  Session s = session();
  s.run_line("move_point biceps_brachii_long point=4 by=3,0,9 snap=humerus");
  TableMuscle muscle =
      s.document().muscles[std::size_t(find_entry(s.document(), "biceps_brachii_long"))]->left;
  const TablePoint& point = point_of(muscle, 1, 4);
  const Vec3 place = position(*s.document().frame, point);
  EXPECT_EQ(s.document().frame->landmarks[std::size_t(point.landmark)].carrier, "humerus");
  EXPECT_LT((s.workshop().on_bone("humerus", place) - place).norm(), 1e-6);
}

TEST_F(StudioActions, APaintedEndIsSpreadOverTheBoneInTheOrderOfItsStrips) {
  NEED_PACKAGES();
  Session s = session();
  const auto entry = [&](const Session& of) -> const EditedMuscle& {
    return *of.document().muscles[std::size_t(find_entry(of.document(), "adductor_magnus_middle"))];
  };
  s.run_line("remove_strip adductor_magnus_middle strip=1");
  s.run_line("undo");
  const EditedMuscle before = entry(s);
  const std::size_t strips = before.left.strips.size();
  std::string places;
  for (int k = 0; k < 24; ++k)
    places += (k ? ";femur@90," : "femur@90,") + std::to_string(600 + 8 * k) + ",-190";
  s.run_line("paint_end adductor_magnus_middle end=insertion \"places=" + places + "\"");
  const EditedMuscle& after = entry(s);
  EXPECT_FALSE(after.right) << "both sides";
  ASSERT_EQ(after.left.strips.size(), strips);
  std::vector<std::pair<double, double>> heights;  // before and now
  for (std::size_t k = 0; k < strips; ++k) {
    const TablePoint& end = after.left.strips[k].path.back();
    const Vec3 place = position(*s.document().frame, end);
    EXPECT_EQ(s.document().frame->landmarks[std::size_t(end.landmark)].carrier, "femur");
    EXPECT_LT((s.workshop().on_bone("femur", place) - place).norm(), 1e-4);
    EXPECT_GT(place.y(), 0.58);
    EXPECT_LT(place.y(), 0.81);
    EXPECT_EQ(after.left.strips[k].path.front().landmark,
              before.left.strips[k].path.front().landmark)
        << "the other end stays";
    heights.emplace_back(position(*s.document().frame, before.left.strips[k].path.back()).y(),
                         place.y());
  }
  std::ranges::sort(heights);
  for (std::size_t k = 1; k < heights.size(); ++k)
    EXPECT_GT(heights[k].second, heights[k - 1].second) << "strips do not cross";
  s.run_line("paint_end adductor_magnus_middle_r end=insertion places=femur@90,700,-190");
  EXPECT_TRUE(entry(s).right);
}

TEST_F(StudioActions, AMeshBecomesAMuscleOfItsVolumeAlongIt) {
  NEED_PACKAGES();
  Session s = session();
  const Vec3 from(0.165, 1.42, -0.19), to(0.19, 1.16, -0.17);
  const fs::path mesh = file("spindle.obj", spindle_obj(from, to, 0.018));
  s.run_line("resample_mesh my_spindle file=" + mesh.string() + " points=2 slices=14");
  const TableMuscle muscle =
      s.document().muscles[std::size_t(find_entry(s.document(), "my_spindle"))]->left;
  const double radius = 0.018, volume = 0.5 * M_PI * radius * radius * (to - from).norm();
  EXPECT_NEAR(muscle.volume_male / volume, 1, 0.04);
  ASSERT_EQ(muscle.strips.size(), 1u);
  EXPECT_EQ(muscle.strips[0].path.size(), 4u);
  EXPECT_EQ(muscle.strips[0].sections.size(), 14u);
  double widest = 0;
  for (const TableSection& section : muscle.strips[0].sections)
    widest = std::max(widest, section.radii.x());
  EXPECT_NEAR(widest, radius, 0.0015);
  // the points between lie on its middle
  for (const std::size_t k : {1u, 2u}) {
    const Vec3 place =
        table_place(position(*s.document().frame, muscle.strips[0].path[k]), Side::left);
    const Vec3 along = (to - from).normalized(), away = place - from;
    EXPECT_LT((away - away.dot(along) * along).norm(), 0.003);
  }
  EXPECT_NO_THROW(placed_entry(s.workshop(), s.document(), find_entry(s.document(), "my_spindle")));
}

TEST_F(StudioActions, MistakesSayFileLineActionArgumentValueAndTheRightWord) {
  Session s = session();
  const std::string start = document_text(s.document());
  const auto says = [&](const std::string& line, std::initializer_list<const char*> parts) {
    const fs::path script = file("bad.txt", "\n" + line + "\n");
    const std::string said = why([&] { s.run_script(script); });
    EXPECT_NE(said.find("bad.txt:2: "), std::string::npos) << said;
    for (const char* part : parts) EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  says("mvoe_point soleus point=1 by=0,0,1", {"mvoe_point", "move_point"});
  says("move_point soleus piont=1 by=0,0,1", {"move_point", "piont", "did you mean point"});
  says("move_point soles point=1 by=0,0,1", {"move_point", "soles", "soleus"});
  says("move_point soleus point=99 by=0,0,1", {"point", "99"});
  says("move_point soleus point=30 by=0,0,1", {"'point': '30'", "1 .. "});
  says("move_point soleus point=1 by=0,0", {"'by': '0,0'", "mm"});
  says("move_point soleus point=1 by=0,0,1deg", {"'by'", "1deg"});
  says("set_muscle soleus volume=nan", {"volume", "nan", "ml"});
  says("set_muscle soleus volume=1e9", {"volume", "5000"});
  says("mirror_muscle soleus from=lft", {"'from': 'lft'", "left"});
  says("add_point soleus at=asiss", {"asiss", "asis"});
  says("set_belly soleus begin=0.9 end=0.2", {"soleus", "belly"});
  says("copy_muscle soleus as=Soleus2", {"'as': 'Soleus2'", "small letters"});
  says("copy_muscle soleus as=tibialis_anterior", {"there is a muscle of that name"});
  says("remove_wrap elbow_front", {"elbow_front", "leave_wrap"});
  says("undo", {"undo", "nothing to take back"});
  says("include none.txt", {"none.txt"});
  says("activate nerve:femural_nerve value=1", {"femural", "nerve:femoral_nerve"});
  says("activate soleus value=1 from=0.5", {"'at' is missing"});
  says("activate soleus value=1 at=1 from=0.5", {"'from': '0.5'", "no key"});
  says("relax soleus", {"'muscles': 'soleus'", "not activated"});
  says("compare liner_blend", {"'with': 'liner_blend'", "linear_blend"});
  says("set_layer 1.2 site=bely", {"'site': 'bely'", "no such site"});
  says("set_body " + folder_.string(), {"a folder", "ecorche studio FOLDER"});
  says("describe_muscle soleus \"note=never ends", {"quotation"});
  says("include bad.txt", {"include"});
  EXPECT_EQ(document_text(s.document()), start);
}

}  // namespace
}  // namespace ecorche
