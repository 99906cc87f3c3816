// Sessions without a project: what one that was killed leaves, and who may take it up.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "anatomy/errors.h"
#include "app/edit/document/document.h"
#include "app/edit/journal.h"
#include "app/edit/session.h"
#include "app/edit/unsaved_sessions.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

class UnsavedSessions : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("unsaved." + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    states_ = folder_ / "states";
    common_.assets = test_assets();
    common_.quiet = true;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::unique_ptr<Session> session() {
    auto out = std::make_unique<Session>(common_, report_, SessionOptions{});
    out->keep_unsaved(states_);
    return out;
  }
  // A session that does so many moves, and is killed.
  void kill_after(int moves) {
    const pid_t child = fork();
    if (child == 0) {
      const std::unique_ptr<Session> s = session();
      for (int k = 0; k < moves; ++k) s->run_line(move(k));
      kill(getpid(), SIGKILL);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
  }
  // A step from where a point is: one that was done twice would show.
  static std::string move(int k) {
    return "move_point " + std::string(k % 2 ? "soleus" : "plantaris") + " point=2 by=0,0,0.5";
  }
  std::string text_after(int moves) {
    Session whole(common_, report_, {});
    for (int k = 0; k < moves; ++k) whole.run_line(move(k));
    return document_text(whole.document());
  }

  fs::path folder_, states_;
  Common common_;
  Report report_;
};

TEST_F(UnsavedSessions, WhatWasKilledIsTakenUpWhole) {
  for (const int moves : {1, 2, 17}) {
    kill_after(moves);
    const std::vector<UnsavedSession> left = unsaved_sessions(states_);
    ASSERT_EQ(left.size(), 1u);
    EXPECT_EQ(left[0].lines, moves);
    {
      const std::unique_ptr<Session> s = session();
      EXPECT_EQ(s->take_up(left[0].folder), "");
      EXPECT_EQ(document_text(s->document()), text_after(moves));
      EXPECT_TRUE(s->unsaved());
      EXPECT_TRUE(unsaved_sessions(states_).empty()) << "another could take it as well";
      s->run_line("undo " + std::to_string(moves));
      EXPECT_EQ(document_text(s->document()), text_after(0));
      s->run_line("redo");
    }
    // that session, too, ended without a word
    const std::unique_ptr<Session> again = session();
    EXPECT_EQ(again->take_up(unsaved_sessions(states_).at(0).folder), "");
    EXPECT_EQ(document_text(again->document()), text_after(1));
    again->forget_unsaved();
    EXPECT_TRUE(unsaved_sessions(states_).empty());
    EXPECT_TRUE(fs::is_empty(states_));
  }
}

TEST_F(UnsavedSessions, TwoAtOnceKeepApart) {
  const std::unique_ptr<Session> a = session(), b = session();
  EXPECT_FALSE(fs::exists(states_)) << "nothing was done yet";
  a->run_line(move(0));
  b->run_line(move(1));
  b->run_line(move(2));
  std::vector<fs::path> folders(fs::directory_iterator(states_), {});
  ASSERT_EQ(folders.size(), 2u);
  EXPECT_TRUE(unsaved_sessions(states_).empty()) << "both run";
  const std::string before = document_text(a->document());
  for (const fs::path& folder : folders) {
    EXPECT_THROW(a->take_up(folder), OutputError);
    forget_unsaved_session(folder);
    EXPECT_TRUE(fs::exists(folder / kJournalFile)) << "it runs";
  }
  EXPECT_EQ(document_text(a->document()), before);
  a->run_line(move(3));
  a->forget_unsaved();
  folders.assign(fs::directory_iterator(states_), fs::directory_iterator{});
  ASSERT_EQ(folders.size(), 1u);
  EXPECT_EQ(read_journal(folders[0] / kJournalFile).size(), 2u) << "b's own";
}

TEST_F(UnsavedSessions, WhatIsSavedIsLeftNoMore) {
  const std::unique_ptr<Session> s = session();
  s->run_line(move(0));
  EXPECT_FALSE(fs::is_empty(states_));
  s->run_line("save \"" + (folder_ / "project").string() + "\"");
  EXPECT_TRUE(fs::is_empty(states_));
  s->run_line(move(1));
  EXPECT_TRUE(fs::is_empty(states_)) << "the project has its own";
  EXPECT_EQ(read_journal(folder_ / "project" / kJournalFile).size(), 1u);
  s->forget_unsaved();
  EXPECT_EQ(read_journal(folder_ / "project" / kJournalFile).size(), 1u);
}

// In place of a session in which nothing was done: its window offers the latest projects.
TEST_F(UnsavedSessions, AProjectIsGoneOnWith) {
  const fs::path project = folder_ / "project";
  {
    const std::unique_ptr<Session> s = session();
    EXPECT_THROW(s->take_up_project(project), InputError) << "there is none yet";
    EXPECT_FALSE(s->has_project());
    s->run_line(move(0));
    s->run_line("save \"" + project.string() + "\"");
    EXPECT_THROW(session()->take_up_project(project), OutputError) << "it runs";
  }
  {
    const std::unique_ptr<Session> s = session();
    EXPECT_EQ(s->take_up_project(project), "");
    EXPECT_EQ(document_text(s->document()), text_after(1));
    EXPECT_EQ(document_text(s->saved()), text_after(1));
    EXPECT_TRUE(s->has_project());
    EXPECT_FALSE(s->unsaved());
    EXPECT_FALSE(fs::exists(states_) && !fs::is_empty(states_));
    s->run_line(move(1));  // and it is killed
  }
  const std::unique_ptr<Session> again = session();
  EXPECT_EQ(again->take_up_project(project), "");
  EXPECT_EQ(document_text(again->document()), text_after(2));
  EXPECT_EQ(document_text(again->saved()), text_after(1));
  EXPECT_TRUE(again->unsaved());
  again->run_line("undo");
  EXPECT_FALSE(again->unsaved());
}

// As one of an older version, whose action has another name by now.
TEST_F(UnsavedSessions, ALineThatIsRefusedEndsWhatIsDoneAgain) {
  kill_after(3);
  const fs::path left = unsaved_sessions(states_).at(0).folder;
  std::ofstream(left / kJournalFile, std::ios::app) << "shift_point soleus by=1\n"
                                                    << move(0) << "\n";
  {
    const std::unique_ptr<Session> s = session();
    const std::string fault = s->take_up(left);
    EXPECT_NE(fault.find("journal.txt:4: 'shift_point' is no action"), std::string::npos) << fault;
    EXPECT_EQ(document_text(s->document()), text_after(3));
    s->run_line(move(3));
  }
  const std::unique_ptr<Session> again = session();
  EXPECT_EQ(again->take_up(left), "") << "the line stops nobody any more";
  EXPECT_EQ(document_text(again->document()), text_after(4));
}

TEST_F(UnsavedSessions, WithoutAFolderToWriteToItIsSaidAndGoesOn) {
  std::ofstream(folder_ / "file") << "no folder";
  for (const fs::path& states : {folder_ / "file" / "states", fs::path("/proc/ecorche")}) {
    Session s(common_, report_, {});
    s.keep_unsaved(states);
    EXPECT_EQ(s.no_journal(), "");
    s.run_line(move(0));
    s.run_line(move(1));
    EXPECT_NE(s.no_journal().find(states.string()), std::string::npos) << s.no_journal();
    EXPECT_EQ(document_text(s.document()), text_after(2));
  }
}

TEST_F(UnsavedSessions, InputsAreFoundFromEveryFolder) {
  const fs::path here = fs::current_path();
  std::ofstream(folder_ / "tip.obj") << "v 0 0 0\nv 0.01 0 0\nv 0 0.01 0\nv 0 0 0.01\n"
                                        "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  std::string text;
  {
    fs::current_path(folder_);
    const std::unique_ptr<Session> s = session();
    s->run_line("add_bone tip pelvis file=tip.obj unit=m");
    text = document_text(s->document());
    fs::current_path(here);
  }
  const std::unique_ptr<Session> again = session();
  EXPECT_EQ(again->take_up(unsaved_sessions(states_).at(0).folder), "");
  EXPECT_EQ(document_text(again->document()), text);
}

}  // namespace
}  // namespace ecorche
