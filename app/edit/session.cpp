#include "app/edit/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <type_traits>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/similar_names.h"
#include "app/edit/comparison.h"
#include "app/edit/document/edit_muscle.h"
#include "app/edit/model_outputs.h"
#include "app/edit/muscle_file.h"
#include "app/edit/muscle_gauge.h"
#include "app/edit/palpable_points.h"
#include "app/edit/project.h"
#include "app/edit/refit.h"
#include "app/edit/trial_pose.h"
#include "app/edit/unsaved_sessions.h"
#include "app/files/character_file.h"
#include "app/files/fitted_actor.h"

namespace ecorche {
namespace {

// The saved state was undone and is forgotten: no step of the history is it.
constexpr std::size_t kNeverAgain = std::numeric_limits<std::size_t>::max();
constexpr int kMostIncludes = 20;
constexpr std::size_t kMostScriptBytes = 16u << 20;

// With its input named so that it is found from every folder.
Action with_absolute_file(Action action) {
  std::visit(
      [](auto& x) {
        using T = std::decay_t<decltype(x)>;
        if constexpr (std::is_same_v<T, SetBody> || std::is_same_v<T, PlayMotion> ||
                      std::is_same_v<T, ImportMuscle> || std::is_same_v<T, AddBone> ||
                      std::is_same_v<T, ResampleMesh>) {
          if (!x.file.empty()) x.file = std::filesystem::absolute(x.file).lexically_normal();
        } else if constexpr (std::is_same_v<T, Compare>) {
          if (names_file(x.with)) x.with = std::filesystem::absolute(x.with).lexically_normal();
        }
      },
      action);
  return action;
}

// nerve:NAME and function:NAME among the parts of a picture.
Render with_groups_spelled(Workshop& workshop, Render picture) {
  for (std::string* names : {&picture.only, &picture.hide, &picture.labels})
    if (names->find(':') != std::string::npos) *names = spelled_groups(workshop.groups(), *names);
  return picture;
}

}  // namespace

Session::Session(const Common& common, Report& report, const SessionOptions& options, Drawer draw)
    : common_(common),
      report_(report),
      draw_(std::move(draw)),
      workshop_(options.built_in ? Workshop(common.assets, *options.built_in)
                                 : Workshop(common.assets)),
      project_(options.project),
      given_other_(options.other),
      bodies_(workshop_, common, report) {
  if (options.document) {
    history_ = begin_history(*options.document);
  } else if (project_.empty() || !open_project(options.discard)) {
    history_ = begin_history(workshop_.built_in());
  }
  if (saved_document_.muscles.empty()) saved_document_ = document();
  if (project_.empty()) return;
  make_output_folder(project_);
  kept_in_ = project_;
  const std::filesystem::path file = project_ / kJournalFile;
  journal_ = std::make_unique<Journal>(file);
  if (!options.discard)
    recover(file);
  else if (aside_.empty())
    journal_->begin();
  else
    journal_->append(std::string(kSaves) + aside_);
}

void Session::begin_here() {
  saved_ = history_.now;
  saved_document_ = document();
}

// As it was saved, or as the journal goes on from it: a session that was killed while it saved has
// written the project in part.
bool Session::open_project(bool discard) {
  aside_ = begin_of_journal(read_journal(project_ / kJournalFile), discard).folder;
  if (aside_.empty() && !is_project(project_)) return false;
  OpenedProject opened = read_project(workshop_, project_ / aside_);
  for (const std::string& text : opened.notes)
    note(common_, fmt::format("{}: {}", project_.string(), text));
  history_ = begin_history(std::move(opened.document));
  if (aside_.empty()) return true;
  saved_ = kNeverAgain;
  try {
    saved_document_ = read_project(workshop_, project_).document;
  } catch (const Error&) {
    saved_document_ = document();
  }
  return true;
}

void Session::recover(const std::filesystem::path& file) {
  const std::vector<std::string> lines = read_journal(file);
  if (const std::string fault = do_again(file, lines); !fault.empty())
    throw InputError(fault + "; --discard leaves what was not saved");
}

// Returns what was wrong with the first line that could not be done again.
std::string Session::do_again(const std::filesystem::path& file,
                              const std::vector<std::string>& lines) {
  const std::size_t before = begin_of_journal(lines).line;
  std::string fault;
  std::size_t k = before;
  recovering_ = true;
  for (; k < lines.size() && fault.empty(); ++k) {
    try {
      run_line(lines[k]);
    } catch (const Error& error) {
      fault = fmt::format("{}:{}: {}", file.string(), k + 1, error.what());
    }
  }
  recovering_ = false;
  const int again = int(k) - int(before) - (fault.empty() ? 0 : 1);
  if (again > 0)
    note(common_, fmt::format("{}: {} actions that were not saved are done again; undo takes them "
                              "back",
                              file.string(), again));
  report_.set("recovered", again);
  return fault;
}

void Session::keep_unsaved(const std::filesystem::path& folder) { states_ = folder; }

std::string Session::take_up(const std::filesystem::path& session) {
  const std::filesystem::path file = session / kJournalFile;
  auto journal = std::make_unique<Journal>(file);
  const std::vector<std::string> lines = read_journal(file);
  const std::string aside = begin_of_journal(lines).folder;
  History begin = begin_history(aside.empty() ? workshop_.built_in()
                                              : read_project(workshop_, session / aside).document);
  forget_unsaved();
  kept_in_ = session;
  aside_ = aside;
  history_ = std::move(begin);
  saved_ = kNeverAgain;
  saved_document_ = workshop_.built_in();
  return go_on_with(std::move(journal), file, lines);
}

std::string Session::go_on_with(std::unique_ptr<Journal> journal, const std::filesystem::path& file,
                                const std::vector<std::string>& lines) {
  journal_ = std::move(journal);
  journal_begin_ = 0;
  std::string fault = do_again(file, lines);
  // the line would stop the next one that takes it up, too
  if (!fault.empty()) begin_journal_here(kFrom);
  return fault;
}

std::string Session::take_up_project(const std::filesystem::path& project) {
  const std::filesystem::path file = project / kJournalFile;
  const std::vector<std::string> lines = read_journal(file);
  const std::string aside = begin_of_journal(lines).folder;
  const bool written = !aside.empty() || is_project(project);
  if (!written && lines.empty())  // one that was never saved is its journal alone
    throw InputError(fmt::format("{}: is no project", project.string()));
  Document begin =
      written ? read_project(workshop_, project / aside).document : workshop_.built_in();
  auto journal = std::make_unique<Journal>(file);
  forget_unsaved();
  project_ = kept_in_ = project;
  no_journal_.clear();
  aside_ = aside;
  history_ = begin_history(std::move(begin));
  saved_ = aside.empty() ? history_.now : kNeverAgain;
  saved_document_ = document();
  return go_on_with(std::move(journal), file, lines);
}

void Session::forget_unsaved() {
  if (has_project() || !journal_) return;
  journal_.reset();
  forget_unsaved_session(kept_in_);
}

// A session without a project has a journal from its first action on, and none where it cannot be
// written: then that is said, and the session goes on.
bool Session::begin_unsaved() {
  if (states_.empty() || has_project() || !no_journal_.empty()) return false;
  try {
    kept_in_ = make_unsaved_session(states_);
    journal_ = std::make_unique<Journal>(kept_in_ / kJournalFile);
    for (std::size_t k = 1; k < history_.steps.size(); ++k)
      journal_->append(
          action_line(with_absolute_file(read_action(history_.steps[k].line).value())));
    return true;
  } catch (const OutputError& error) {
    lose_journal(error);
    return false;
  }
}

void Session::lose_journal(const OutputError& error) {
  journal_.reset();
  no_journal_ = fmt::format("what is not saved would be lost by a crash: {}", error.what());
  note(common_, no_journal_);
}

// Before the document changes, so that what is seen is on disk.
void Session::note_in_journal(const Action& action) {
  if (recovering_ || (!journal_ && !begin_unsaved())) return;
  try {
    journal_->append(action_line(with_absolute_file(action)));
  } catch (const OutputError& error) {
    if (has_project()) throw;
    lose_journal(error);
  }
}

void Session::run(const Action& action) {
  if (std::optional<Document> next = applied(workshop_, document(), action)) {
    note_in_journal(action);
    if (history_.now < saved_) saved_ = kNeverAgain;
    add_step(history_, std::move(*next), action_line(action));
    return;
  }
  std::visit(
      [this](const auto& x) {
        if constexpr (requires { do_beside(x); }) do_beside(x);
      },
      action);
}

void Session::run_line(const std::string& line) {
  const std::optional<Action> action = read_action(line);
  if (!action) return;
  try {
    run(*action);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", split_words(line).front(), error.what()));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", split_words(line).front(), error.what()));
  }
}

void Session::run_script(const std::filesystem::path& file) { run_script_at(file, 0); }

void Session::run_script_at(const std::filesystem::path& file, int depth) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read", file.string()));
  const std::string text(std::istreambuf_iterator<char>(in), {});
  if (text.size() > kMostScriptBytes)
    throw LimitError(fmt::format("{}: larger than {} bytes", file.string(), kMostScriptBytes));
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::string where = fmt::format("{}:{}", file.string(), number);
    std::filesystem::path included;
    try {
      const std::vector<std::string> words = split_words(line);
      if (words.empty()) continue;
      if (words[0] != "include") {
        run_line(line);
        continue;
      }
      if (words.size() != 2) throw InputError("include: expected one file");
      included = file.parent_path() / words[1];
      if (depth == kMostIncludes)
        throw InputError(fmt::format("include: '{}': scripts that include each other", words[1]));
      if (!std::filesystem::is_regular_file(included))
        throw InputError(fmt::format("include: '{}': there is no such file", words[1]));
    } catch (const UnfitError& error) {
      throw UnfitError(fmt::format("{}: {}", where, error.what()));
    } catch (const OutputError& error) {
      throw OutputError(fmt::format("{}: {}", where, error.what()));
    } catch (const Error& error) {
      throw InputError(fmt::format("{}: {}", where, error.what()));
    }
    run_script_at(included, depth + 1);
  }
}

void Session::do_beside(const Undo& x) {
  if (undo_steps(history_, x.steps) == 0) throw InputError("there is nothing to take back");
  if (history_.now >= journal_begin_)
    note_in_journal(x);
  else if (journal_)
    begin_journal_here(kFrom);
}

// As the actions that are done again: a session that recovers knows none that were undone.
void Session::do_beside(const Redo& x) {
  const int done = redo_steps(history_, x.steps);
  if (done == 0) throw InputError("there is nothing to do again");
  if (!journal_ || recovering_) return;
  for (std::size_t k = history_.now + 1 - std::size_t(done); k <= history_.now; ++k)
    note_in_journal(read_action(history_.steps[k].line).value());
}

// The journal goes on from the document as it is, which is kept beside it.
void Session::begin_journal_here(std::string_view word) {
  const std::string folder = aside_ == kAsideFolders[0] ? kAsideFolders[1] : kAsideFolders[0];
  std::filesystem::remove_all(kept_in_ / folder);
  write_project(workshop_, document(), kept_in_ / folder);
  journal_->append(std::string(word) + folder);
  aside_ = folder;
  journal_begin_ = history_.now;
}

void Session::do_beside(const Save& x) {
  const std::filesystem::path folder =
      x.folder.empty() ? project_ : std::filesystem::path(x.folder);
  if (folder.empty())
    throw InputError("argument 'folder' is missing: this session has no project yet");
  check_project_folder(folder);
  const std::filesystem::path unsaved = has_project() || !journal_ ? "" : kept_in_;
  if (folder != project_) {
    make_output_folder(folder);
    auto journal = std::make_unique<Journal>(folder / kJournalFile);
    std::swap(journal_, journal);
    project_ = kept_in_ = folder;
    aside_.clear();
  }
  // Whenever it is killed, either the copy beside or the project is whole.
  begin_journal_here(kSaves);
  write_project(workshop_, document(), folder);
  journal_->begin();
  for (const char* aside : kAsideFolders) std::filesystem::remove_all(project_ / aside);
  if (!unsaved.empty()) forget_unsaved_session(unsaved);
  no_journal_.clear();
  aside_.clear();
  saved_ = journal_begin_ = history_.now;
  saved_document_ = document();
  note(common_, fmt::format("{}: saved", folder.string()));
}

void Session::do_beside(const ExportMuscle& x) {
  const MeantMuscle meant = meant_muscle(document(), x.muscle);
  require_ending(x.file, {".txt"});
  write_file_atomically(x.file, muscle_file_text(document(), workshop_.built_in(), meant.entry));
}

void Session::do_beside(const WriteCharacter& x) {
  for (const std::string& text : write(x.file)) note(common_, "missed: " + text);
}

std::vector<std::string> Session::write(const std::filesystem::path& file) {
  require_ending(file, {".glb"});
  check_outputs(common_, {file});
  FittedActorOptions options;
  options.fitting = fitting_of(document());
  options.fitting.tissues = true;
  const FittedForFile made = fit_for_file(common_.assets, edited_template(workshop_, document()),
                                          edited_body(workshop_, document(), common_, report_),
                                          workshop_.package(), options, report_);
  write_character_file(common_.assets, file, made.bound.character, made.bound.binding, Detail::full,
                       workshop_.package());
  note(common_, fmt::format("{}: {} bones, {} muscles", file.string(),
                            made.bound.character.anatomy.bones.size(),
                            made.bound.character.anatomy.muscles.size()));
  std::vector<std::string> missed;
  for (const MissedTarget& target : missed_targets(made.report)) missed.push_back(target.what);
  return missed;
}

const Character& Session::fitted() { return bodies_.fitted(document()); }

std::optional<Document> Session::compared() const {
  return given_other_ ? given_other_ : compared_document(history_, saved_document_);
}

void Session::do_beside(const WriteTemplate& x) {
  require_ending(x.file, {".glb"});
  check_outputs(common_, {x.file});
  write_template_file(workshop_, document(), x.file, common_, report_);
}

void Session::do_beside(const WriteModel& x) {
  require_ending(x.file, {".osim", ".xml"});
  check_outputs(common_, {x.file});
  write_fitted_model(workshop_, document(), x.file,
                     {.meshes = x.meshes == "yes", .ground = x.ground == "yes"}, common_, report_);
}

void Session::do_beside(const Render& x) {
  if (!draw_) throw UsageError("this program draws no pictures");
  require_ending(x.file, {".png"});
  check_outputs(common_, {x.file});
  draw_(bodies_.tried(document(), compared(), false),
        Film{.picture = with_groups_spelled(workshop_, x), .shots = {}});
}

void Session::do_beside(const Film& x) {
  if (!draw_) throw UsageError("this program draws no films");
  require_ending(x.picture.file, {".mp4", ".png"});
  if (x.picture.file.find('%') == std::string::npos) check_outputs(common_, {x.picture.file});
  draw_(bodies_.tried(document(), compared(), true),
        Film{with_groups_spelled(workshop_, x.picture), x.shots, x.fps});
}

int Session::joint_meant(const Skeleton& skeleton, const std::string& joint,
                         const std::string& side) {
  if (joint.empty()) return -1;
  const int found = joint_beside(skeleton, joint, side);
  if (found < 0)
    throw InputError(fmt::format("argument 'joint': '{}': there is no such joint{}", joint,
                                 did_you_mean(joint, workshop_.joint_names())));
  return found;
}

void Session::do_beside(const ReportMuscle& x) {
  const MeantMuscle meant = meant_muscle(document(), x.muscle);
  const std::string& name = document().muscles[std::size_t(meant.entry)]->left.name;
  const Anatomy& anatomy = fitted().anatomy;
  const char* side = meant.side == Side::right ? "_r" : "_l";
  const int joint = joint_meant(anatomy.skeleton, x.joint, side);
  const int axis = angle_index(x.angle);
  const int muscle = find_muscle(anatomy, name + side);
  // a motion is read for an actor
  const Pose pose =
      document().trial->motion.empty()
          ? trial_pose(workshop_, document(), anatomy.skeleton, rest_pose(anatomy.skeleton))
          : bodies_.still(document(), bodies_.actor(document())).frames.front();
  const MuscleFigures figures =
      muscle_figures(anatomy, muscle, pose,
                     trial_activation(document(), anatomy, document().trial->seconds), joint, axis);
  const std::string key = "muscles." + name + side;
  report_.set(key + ".length", figures.length);
  report_.set(key + ".rest_length", figures.rest_length);
  report_.set(key + ".volume", figures.volume);
  report_.set(key + ".fibre_length", figures.fibre_length);
  report_.set(key + ".max_force", figures.force);
  if (figures.moment_arm) report_.set(key + ".moment_arm", *figures.moment_arm);
  fmt::print("{}{}: {:.1f} mm long (at rest {:.1f}), {:.1f} ml, fibres {:.1f} mm, {:.0f} N", name,
             side, 1e3 * figures.length, 1e3 * figures.rest_length, 1e6 * figures.volume,
             1e3 * figures.fibre_length, figures.force);
  if (figures.moment_arm)
    fmt::print(", moment arm {:.1f} mm about {} {}", 1e3 * *figures.moment_arm,
               anatomy.skeleton.joints[std::size_t(joint)].name, x.angle);
  fmt::print("\n");
}

void Session::do_beside(const CheckBones&) {
  fitted();
  const std::vector<LandmarkDepth> off = points_off(bodies_.landmarks());
  report_.set("studio.points_off", int(off.size()));
  for (const LandmarkDepth& point : off) fmt::print("{}\n", point_text(point));
  fmt::print("{} of {} palpable points lie otherwise than people's\n", off.size(),
             bodies_.landmarks().size());
}

void Session::do_beside(const WriteCurves& x) {
  require_ending(x.file, {".csv"});
  check_outputs(common_, {x.file});
  if (document().trial->motion.empty())
    throw InputError("there is no motion; play_motion FILE takes one");
  const MeantMuscle meant = meant_muscle(document(), x.muscle);
  const char* side = meant.side == Side::right ? "_r" : "_l";
  const Actor& actor = bodies_.actor(document());
  const Anatomy& anatomy = actor.character.anatomy;
  const int muscle =
      find_muscle(anatomy, document().muscles[std::size_t(meant.entry)]->left.name + side);
  const MuscleGauge gauge(anatomy, muscle, joint_meant(anatomy.skeleton, x.joint, side),
                          angle_index(x.angle));
  const Activations efforts = trial_activations(document(), anatomy);
  const Motion motion = bodies_.motion(document(), actor);
  MuscleCurves curves;
  std::vector<double> effort;
  for (std::size_t k = 0; k < motion.frames.size(); ++k) {
    activation_at(efforts, double(k) / motion.fps, effort);
    add_frame(gauge, motion.frames[k], effort.empty() ? 0 : effort[std::size_t(muscle)], curves);
  }
  finish(gauge, motion.fps, curves);
  write_file_atomically(x.file, table_of(curves, motion.fps));
}

}  // namespace ecorche
