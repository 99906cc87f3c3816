// A session of the studio: a document with its history, and what actions do beside it. Window and
// scripts run the same actions through it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/character.h"
#include "anatomy/errors.h"
#include "app/common_options.h"
#include "app/edit/action_list.h"
#include "app/edit/document/history.h"
#include "app/edit/document/workshop.h"
#include "app/edit/journal.h"
#include "app/edit/tried_bodies.h"
#include "app/report.h"

namespace ecorche {

struct SessionOptions {
  std::filesystem::path project{};  // folder; read where there is one, made by `save`; empty: none
  bool discard = false;             // actions of its journal that were not saved
  // Begins with this document instead, of a workshop with this built-in one; both or none.
  std::optional<Document> document{}, built_in{};
  std::optional<Document> other{};  // that it is compared with; else as its own history has it
};

class Session {
 public:
  // Draws a film, or a still where it has no shots. Without, `render` and `film` throw UsageError.
  using Drawer = std::function<void(const Tried& tried, const Film& film)>;

  // Both are borrowed. Throws as read_project and Journal do; InputError for a journal whose
  // actions cannot be done again.
  Session(const Common& common, Report& report, const SessionOptions& options, Drawer draw = {});

  Workshop& workshop() { return workshop_; }
  const History& history() const { return history_; }
  const Document& document() const { return document_now(history_); }

  // From now on, while it has no project: its journal goes there, from the first action on.
  void keep_unsaved(const std::filesystem::path& folder);
  const std::filesystem::path& kept_unsaved() const { return states_; }  // empty: nowhere
  // Does again what another session without a project has left, and goes on with its journal, in
  // place of all that this one has done. Returns what is wrong with the first line that cannot be
  // done again; the document is then as it was before that. Throws OutputError where a session
  // that runs has it, InputError where it cannot be read; nothing has changed then.
  std::string take_up(const std::filesystem::path& session);
  // Goes on with a project in place of all that this session, which has none, has done; actions of
  // its journal that were not saved are done again. Returns and throws as take_up(); InputError
  // also where there is no project.
  std::string take_up_project(const std::filesystem::path& project);
  // Ends well without a project: nobody is to take it up.
  void forget_unsaved();
  // Why there is no journal; empty where there is one, or none is wanted yet.
  const std::string& no_journal() const { return no_journal_; }

  // Throws as the action does; the document is then as it was.
  void run(const Action& action);
  // A line of a script. Throws InputError that begins with the action's name.
  void run_line(const std::string& line);
  // A script: a line an action, `include FILE` for another script beside it, # for remarks. Throws
  // InputError that begins with file and line.
  void run_script(const std::filesystem::path& file);

  // The document's body with its muscles, fitted; made once for each document that needs another.
  const Character& fitted();
  // What the trial compares it with, where that is another document.
  std::optional<Document> compared() const;
  // Fits, binds and writes it. Returns what misses the accuracy targets of `ecorche fit`.
  std::vector<std::string> write(const std::filesystem::path& file);

  bool unsaved() const { return history_.now != saved_; }
  void begin_here();                                         // what it was opened with is no change
  const Document& saved() const { return saved_document_; }  // or as it began
  bool has_project() const { return !project_.empty(); }
  const std::filesystem::path& project() const { return project_; }

 private:
  void note_in_journal(const Action& action);
  void do_beside(const Undo& x);
  void do_beside(const Redo& x);
  void do_beside(const Save& x);
  void do_beside(const ExportMuscle& x);
  void do_beside(const WriteCharacter& x);
  void do_beside(const WriteTemplate& x);
  void do_beside(const WriteModel& x);
  void do_beside(const Render& x);
  void do_beside(const Film& x);
  void do_beside(const ReportMuscle& x);
  void do_beside(const WriteCurves& x);
  void do_beside(const CheckBones& x);
  // -1: none is named
  int joint_meant(const Skeleton& skeleton, const std::string& joint, const std::string& side);
  bool open_project(bool discard);  // false: there is none
  void recover(const std::filesystem::path& file);
  std::string do_again(const std::filesystem::path& file, const std::vector<std::string>& lines);
  std::string go_on_with(std::unique_ptr<Journal> journal, const std::filesystem::path& file,
                         const std::vector<std::string>& lines);
  bool begin_unsaved();
  void lose_journal(const OutputError& error);
  void begin_journal_here(std::string_view word);
  void run_script_at(const std::filesystem::path& file, int depth);

  const Common& common_;
  Report& report_;
  Drawer draw_;
  Workshop workshop_;
  std::filesystem::path project_, kept_in_, states_;  // kept_in_: the journal's folder
  std::string no_journal_;
  std::unique_ptr<Journal> journal_;
  bool recovering_ = false;
  History history_;
  std::size_t saved_ = 0, journal_begin_ = 0;  // steps of the history
  Document saved_document_;
  std::string aside_;  // folder that the journal goes on from; may be empty
  std::optional<Document> given_other_;
  TriedBodies bodies_;
};

}  // namespace ecorche
