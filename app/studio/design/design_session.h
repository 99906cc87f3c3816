// What the studio's window works on: a session of actions, the body that is shown, what is being
// fitted behind it, and what goes along at once.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/posing/posing_table.h"
#include "app/edit/muscle_gauge.h"
#include "app/edit/session.h"
#include "app/files/actor.h"
#include "app/studio/bodies/background_fit.h"
#include "app/studio/bodies/compared_body.h"
#include "app/studio/bodies/posed_body.h"
#include "app/studio/handles/give_way.h"
#include "app/studio/handles/handles.h"
#include "app/studio/handles/live_muscles.h"
#include "viewer/draw_list.h"
#include "viewer/scene.h"

namespace ecorche {

// An error, and the panel whose line it belongs to.
struct Fault {
  std::string where, text;
};

class DesignSession {
 public:
  // All borrowed. Throws as read_template.
  DesignSession(Session& session, const Common& common, Session::Drawer draw);

  const Session& session() const { return session_; }
  Workshop& workshop() { return session_.workshop(); }
  // The document as it is seen: with what is being tried, before it is an action.
  const Document& seen() const {
    return compared_ ? *compared_ : trying_ ? *trying_ : session_.document();
  }
  // Shows it as it was saved, in the pose of now, until an action is run or tried.
  void show_saved(bool on);
  // What the body is fitted to: without what is being tried.
  const Document& to_fit() const { return compared_ ? *compared_ : session_.document(); }
  bool shows_saved() const { return compared_.has_value(); }
  const Anatomy& anatomy() const { return shown_->character().anatomy; }
  const ShownBody& shown() const { return *shown_; }
  BackgroundFit& fit() { return fit_; }
  ComparedBody& beside() { return beside_; }

  // Runs a line of a script as one step. What fails is said by fault().
  bool run(const std::string& line, const std::string& where);
  // Goes on with a session that was left; what fails is said by fault() as of the bar.
  void take_up(const std::filesystem::path& session);
  void take_up_project(const std::filesystem::path& project);  // likewise
  // Shows what an action would do; the next run() or let_go() ends it.
  void try_out(const Action& action, const std::string& where);
  void try_line(const std::string& line, const std::string& where);
  void let_go() { trying_.reset(), tried_line_.clear(); }
  const std::string& tried_line() const { return tried_line_; }
  // Tries nothing any more, and runs what was tried.
  bool keep_tried(const std::string& where);
  const Fault& fault() const { return fault_; }
  void forget_fault() { fault_ = {}; }
  void refuse(const std::exception& error, const std::string& where);
  // Whether a panel in sight has shown it in this frame.
  bool is_fault_seen() const { return fault_seen_; }
  void note_fault_seen(bool seen = true) { fault_seen_ = seen; }
  const std::string& message() const { return message_; }
  void say(std::string text) { message_ = std::move(text); }

  // Takes over what was finished and begins what is wanted: once a frame, before it.
  void update();
  // Lets muscles go along with what is seen, in the pose of the last pose(). Returns whether other
  // muscles than before are seen.
  bool follow();
  std::uint64_t revision() const { return revision_; }

  // Joints, muscles and skin in a frame of the motion, with the pose and activations of the trial.
  // quick: the skin is blended over the muscles and does not settle, nor do muscles give way to it.
  void pose(int frame, bool quick, PosedAnatomy& posed, SkinFrame& skin);

  // Muscles that go along before the body is fitted, at the pose of the last pose().
  const LiveMuscles& live() const { return live_; }
  bool is_replaced(int muscle) const;  // of the shown anatomy
  // Adds them, and lets their neighbours, fasciae and the skin of `posed` give way.
  void add_live(const PosedAnatomy& posed, const Appearance& appearance, DrawList& list);

  // The muscle that was picked, both sides, as it is seen; empty where none is.
  struct SeenMuscle {
    const Muscle* muscle = nullptr;
    std::vector<Ellipse> slices;  // in the pose of the last pose()
  };
  std::vector<SeenMuscle> picked(const PosedAnatomy& posed) const;
  // Muscles of the shown anatomy that are otherwise than when the document was saved, rising.
  std::vector<int> changed_since_saved() const;
  // Length, force and the like of the picked muscle as it is posed, and its moment arms about a
  // joint (without side, may be empty); while a motion plays, as they were.
  const std::string& figures(const std::string& joint, bool playing);
  // The left picked muscle over the motion, as far as it has been measured; some more with each
  // call.
  const MuscleCurves& curves(const std::string& joint, int axis);
  const BoneCarrier& carrier();
  // Names without sides of the joints that the document has, and whether a side's name is of one.
  const std::vector<std::string>& joint_names();
  bool has_joint(const std::string& sided);
  const std::vector<Vec3>& joint_rest() const { return shown_->model->joint_rest; }

 private:
  void note_file(const Action& action) const;
  void go_on(std::string message, const std::function<std::string()>& take);
  void take_shown(std::shared_ptr<const ShownBody> body);
  bool make_live();
  std::vector<MovedSection> moved_sections(const PosedAnatomy& posed) const;

  Session& session_;
  const Common& common_;
  std::shared_ptr<const ShownBody> shown_;
  BackgroundFit fit_;
  ComparedBody beside_;
  std::optional<ActorState> state_;
  std::optional<LiveMuscleMaker> maker_;
  LiveMuscles live_;
  Document live_of_;  // that the live muscles were made for
  Anatomy live_anatomy_;
  SceneModel live_model_;
  PosingTable live_table_;
  PosedAnatomy live_posed_;
  PointsF live_positions_, live_normals_;
  std::uint64_t live_shape_ = 0, live_revision_ = 0, live_key_ = fresh_scene_key() << 32;
  std::map<std::uint64_t, GivingWay> giving_way_;  // by the keys of skin, muscles and fascia
  TriedFrame frame_;                               // of the last pose()
  std::optional<Document> trying_;
  std::optional<Document> compared_;  // what was saved, in the trial of now
  std::string tried_line_;
  Shared<Trial> trial_;  // that the last pose was made with
  std::uint64_t revision_ = 1;
  Shared<EditedSkeleton> joint_names_of_;
  std::vector<std::string> joint_names_;
  std::optional<MuscleGauge> gauge_;
  int gauged_ = -1;  // muscle of the shown anatomy
  Activations efforts_;
  MuscleCurves curves_;
  std::string curves_of_;
  std::string figures_, figures_of_;                  // and what they were made for
  std::uint64_t pose_number_ = 0, figures_pose_ = 0;  // of frame_
  Fault fault_;
  bool fault_seen_ = false;
  std::string message_;
};

}  // namespace ecorche
