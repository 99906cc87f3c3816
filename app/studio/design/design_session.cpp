#include "app/studio/design/design_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/posing/pose_anatomy.h"
#include "app/edit/document/edited_skeleton.h"
#include "app/edit/recent_files.h"
#include "app/edit/trial_pose.h"
#include "morph/placement/bone_groups.h"
#include "viewer/scene_order.h"

namespace ecorche {
namespace {

// Actions that take long: they run beside, on the document as it is.
bool takes_long(const Action& action) {
  return std::holds_alternative<WriteCharacter>(action) || std::holds_alternative<Render>(action) ||
         std::holds_alternative<Film>(action) || std::holds_alternative<WriteTemplate>(action) ||
         std::holds_alternative<WriteModel>(action) ||
         std::holds_alternative<ReportMuscle>(action) ||
         std::holds_alternative<CheckBones>(action) || std::holds_alternative<WriteCurves>(action);
}

}  // namespace

DesignSession::DesignSession(Session& session, const Common& common, Session::Drawer draw)
    : session_(session),
      common_(common),
      shown_(
          unfitted_body(common.assets, session.workshop().base(), session.workshop().built_in())),
      fit_(common, session.workshop().built_in(), shown_, std::move(draw)),
      beside_(common, session.workshop().built_in(), shown_) {
  workshop().warp();  // read before a hand waits for it
  take_shown(shown_);
}

void DesignSession::take_shown(std::shared_ptr<const ShownBody> body) {
  shown_ = std::move(body);
  state_.reset();
  if (shown_->actor) state_.emplace(*shown_->actor);
  maker_.reset();
  live_ = {};
  live_of_ = shown_->of;
  giving_way_.clear();
  ++revision_;
}

const BoneCarrier& DesignSession::carrier() {
  if (!maker_) maker_.emplace(workshop(), shown_->of, anatomy());
  return maker_->carrier();
}

void DesignSession::refuse(const std::exception& error, const std::string& where) {
  fault_ = {where, error.what()};
}

const std::vector<std::string>& DesignSession::joint_names() {
  if (joint_names_of_ != seen().skeleton) {
    joint_names_of_ = seen().skeleton;
    joint_names_ = ecorche::joint_names(workshop(), seen());
  }
  return joint_names_;
}

bool DesignSession::has_joint(const std::string& sided) {
  const std::vector<std::string>& names = joint_names();
  const auto has = [&](const std::string& name) {
    return std::ranges::find(names, name) != names.end();
  };
  return has(sided) || has(split_side(sided).first);
}

void DesignSession::show_saved(bool on) {
  let_go();
  compared_.reset();
  if (!on) return;
  compared_ = session_.saved();
  compared_->trial = session_.document().trial;
  compared_->picked = session_.document().picked;
}

bool DesignSession::run(const std::string& line, const std::string& where) {
  let_go();
  compared_.reset();
  fault_ = {};
  message_.clear();
  try {
    const std::optional<Action> action = read_action(line);
    if (!action) return false;
    if (takes_long(*action))
      fit_.run_beside(session_.document(), session_.compared(), action_line(*action));
    else
      session_.run(*action);
    if (std::holds_alternative<Save>(*action)) message_ = "saved";
    note_file(*action);
    return true;
  } catch (const std::exception& error) {
    refuse(error, where);
    return false;
  }
}

// For the lists of recent files.
void DesignSession::note_file(const Action& action) const {
  const std::filesystem::path& states = session_.kept_unsaved();
  if (const auto* body = std::get_if<SetBody>(&action); body && body->file != "none")
    note_recent(states, {"body", body->file});
  if (const auto* motion = std::get_if<PlayMotion>(&action); motion && motion->file != "none")
    note_recent(states, {"motion", motion->file});
  if (const auto* save = std::get_if<Save>(&action); save && !save->folder.empty())
    note_recent(states, {"project", save->folder});
}

void DesignSession::take_up(const std::filesystem::path& session) {
  go_on("done again; undo takes it back", [&] { return session_.take_up(session); });
}

void DesignSession::take_up_project(const std::filesystem::path& project) {
  go_on(project.string(), [&] { return session_.take_up_project(project); });
  if (session_.has_project()) note_recent(session_.kept_unsaved(), {"project", project});
}

void DesignSession::go_on(std::string message, const std::function<std::string()>& take) {
  let_go();
  compared_.reset();
  fault_ = {};
  message_ = std::move(message);
  try {
    const std::string fault = take();
    if (!fault.empty()) fault_ = {"bar", "done again up to a line that is refused: " + fault};
  } catch (const std::exception& error) {
    message_.clear();
    refuse(error, "bar");
  }
}

void DesignSession::try_out(const Action& action, const std::string& where) {
  try {
    std::optional<Document> next = applied(workshop(), session_.document(), action);
    if (!next) return;
    compared_.reset();
    trying_ = std::move(next);
    tried_line_ = action_line(action);
    fault_ = {};
  } catch (const std::exception& error) {
    refuse(error, where);
  }
}

void DesignSession::try_line(const std::string& line, const std::string& where) {
  try {
    if (const std::optional<Action> action = read_action(line)) try_out(*action, where);
  } catch (const std::exception& error) {
    refuse(error, where);
  }
}

bool DesignSession::keep_tried(const std::string& where) {
  const std::string line = tried_line_;
  return !line.empty() && run(line, where);
}

// Muscles of the document that is seen, where the shown body has others.
bool DesignSession::make_live() {
  const Document& wanted = seen();
  if (wanted.muscles == live_of_.muscles && wanted.frame == live_of_.frame) return false;
  if (!maker_) maker_.emplace(workshop(), shown_->of, anatomy());
  try {
    live_ = maker_->make(wanted);
  } catch (const std::exception& error) {
    refuse(error, "muscle");
  }
  live_of_ = wanted;
  if (live_.muscles.empty()) return true;
  live_anatomy_.skeleton = anatomy().skeleton;
  live_anatomy_.muscles = live_.muscles;
  try {
    live_table_ = make_posing_table(live_anatomy_);
    live_model_ = make_scene_model(live_anatomy_, {});
  } catch (const std::exception& error) {
    live_ = {};
    refuse(error, "muscle");
  }
  ++live_shape_;
  return true;
}

void DesignSession::update() {
  fit_.ask(to_fit());
  if (BackgroundFit::Said said = fit_.take_message(); said.failed)
    fault_ = {"beside", std::move(said.text)};
  else if (!said.text.empty())
    message_ = std::move(said.text);
  if (auto newest = fit_.newest(); newest != shown_) take_shown(std::move(newest));
  beside_.update(seen(), session_.compared(), shown_);
  if (seen().trial == trial_) return;
  trial_ = seen().trial;
  ++revision_;
}

bool DesignSession::follow() {
  const bool changed = make_live();
  if (live_.muscles.empty()) return changed;
  std::vector<double> activation(live_.muscles.size(), 0);
  for (std::size_t m = 0; m < activation.size(); ++m) {
    const int own = find_muscle(anatomy(), live_.muscles[m].name);
    if (own >= 0 && std::size_t(own) < frame_.efforts.size())
      activation[m] = frame_.efforts[std::size_t(own)];
  }
  pose_anatomy(live_table_, live_anatomy_.skeleton, frame_.pose, live_posed_, 1, activation);
  return changed;
}

const std::string& DesignSession::figures(const std::string& joint, bool playing) {
  const std::string of = fmt::format("{} {} {}", revision_, seen().picked, joint);
  if (of == figures_of_ && (playing || figures_pose_ == pose_number_)) return figures_;
  figures_of_ = of;
  figures_pose_ = pose_number_;
  figures_.clear();
  const int muscle = find_muscle(anatomy(), seen().picked + "_l");
  if (muscle < 0 || !state_) return figures_;
  const int about = joint_beside(anatomy().skeleton, joint, "_l");
  std::vector<double> effort = frame_.efforts;
  effort.resize(anatomy().muscles.size(), 0);
  const MuscleFigures f = muscle_figures(anatomy(), muscle, frame_.pose, effort, -1, 0);
  figures_ = fmt::format("{:.1f} mm long, {:+.1f} % of rest\n{:.3g} ml, {:.0f} N", 1e3 * f.length,
                         100 * (f.length / f.rest_length - 1), 1e6 * f.volume, f.force);
  for (int axis = 0; axis < 3 && about >= 0; ++axis) {
    const auto arm = muscle_figures(anatomy(), muscle, frame_.pose, effort, about, axis).moment_arm;
    if (arm)
      figures_ += fmt::format("\nmoment arm {:.1f} mm about {} {}", 1e3 * *arm, joint,
                              kAngleNames[std::size_t(axis)]);
  }
  return figures_;
}

const MuscleCurves& DesignSession::curves(const std::string& joint, int axis) {
  constexpr std::size_t at_once = 30;  // frames, so that no picture waits
  const Motion& motion = *shown_->motion;
  const std::string of = fmt::format("{} {} {} {}", revision_, seen().picked, joint, axis);
  if (of != curves_of_) {
    curves_of_ = of;
    curves_ = {};
    gauge_.reset();
    gauged_ = find_muscle(anatomy(), seen().picked + "_l");
    if (gauged_ < 0 || !state_) return curves_;
    gauge_.emplace(anatomy(), gauged_, joint_beside(anatomy().skeleton, joint, "_l"), axis);
    efforts_ = trial_activations(seen(), anatomy());
  }
  if (!gauge_) return curves_;
  const std::size_t end = std::min(curves_.lengths.size() + at_once, motion.frames.size());
  std::vector<double> effort;
  for (std::size_t k = curves_.lengths.size(); k < end; ++k) {
    activation_at(efforts_, double(k) / motion.fps, effort);
    add_frame(*gauge_, trial_pose(workshop(), seen(), anatomy().skeleton, motion.frames[k]),
              effort.empty() ? 0 : effort[std::size_t(gauged_)], curves_);
  }
  if (end == motion.frames.size() && curves_.speeds.size() != end)
    finish(*gauge_, motion.fps, curves_);
  return curves_;
}

void DesignSession::pose(int frame, bool quick, PosedAnatomy& posed, SkinFrame& skin) {
  ++pose_number_;
  try {
    frame_ = tried_frame(workshop(), seen(), *shown_, frame);
  } catch (const std::exception& error) {
    refuse(error, "try");
    frame_ = {shown_->motion->frames.front(), {}};
  }
  if (state_)
    evaluate_tried(*shown_->actor, frame_, quick, *state_, posed, skin);
  else
    stand(shown_->character(), posed, skin);
}

bool DesignSession::is_replaced(int muscle) const {
  return std::ranges::find(live_.replaced, anatomy().muscles[std::size_t(muscle)].name) !=
         live_.replaced.end();
}

// Sections of both sides of a muscle alike: as the shown body has them, and as they are now.
std::vector<MovedSection> DesignSession::moved_sections(const PosedAnatomy& posed) const {
  std::vector<MovedSection> out;
  for (const SliceRange& now : live_model_.strips) {
    const int own = find_muscle(anatomy(), live_.muscles[std::size_t(now.muscle)].name);
    for (const SliceRange& before : shown_->model->strips) {
      if (before.muscle != own || before.strip != now.strip) continue;
      const int count = now.end - now.begin, counted = before.end - before.begin;
      for (int k = 0; k < count && counted > 0; ++k) {
        const int was = before.begin + k * (counted - 1) / std::max(count - 1, 1);
        const Ellipse &from = posed.slices[std::size_t(was)],
                      &to = live_posed_.slices[std::size_t(now.begin + k)];
        out.push_back({from, to});
      }
    }
  }
  return out;
}

void DesignSession::add_live(const PosedAnatomy& posed, const Appearance& appearance,
                             DrawList& list) {
  const std::vector<MovedSection> moved =
      live_.muscles.empty() ? std::vector<MovedSection>() : moved_sections(posed);
  for (const int index : {kSkinMesh, kMuscleMesh, kFasciaMesh}) {
    DrawMesh& mesh = list.meshes[std::size_t(index)];
    giving_way_[mesh.key].move(moved, mesh);
  }
  if (live_.muscles.empty() || appearance.looks.front().muscles <= 0) return;
  std::vector<std::uint32_t> parts(live_.muscles.size());
  for (std::size_t m = 0; m < parts.size(); ++m) {
    const int own = find_muscle(anatomy(), live_.muscles[m].name);
    parts[m] = kFirstMusclePart + std::uint32_t(own >= 0 ? own : int(anatomy().muscles.size() + m));
  }
  update_muscle_surface(live_model_.surface, live_posed_, live_positions_, &live_normals_);
  DrawMesh mesh = live_model_.muscles;
  mesh.key = live_key_;
  mesh.shape = live_shape_;
  mesh.revision = ++live_revision_;
  const auto take = [](const PointsF& from, std::vector<Vec3f>& to) {
    to.resize(std::size_t(from.rows()));
    for (Eigen::Index i = 0; i < from.rows(); ++i) to[std::size_t(i)] = from.row(i).transpose();
  };
  take(live_positions_, mesh.positions);
  take(live_normals_, mesh.normals);
  mesh.colors.resize(mesh.positions.size());
  for (const MuscleSurface::Part& part : live_model_.surface.parts) {
    const std::uint32_t number = parts[std::size_t(part.muscle)];
    Appearance own = appearance;
    own.hidden.clear();
    const MuscleTones tones = muscle_tones(own, int(number - kFirstMusclePart), 0);
    for (int i = part.vertex_begin; i < part.vertex_end; ++i) {
      const float belly = live_model_.surface.belly[std::size_t(i)];
      mesh.colors[std::size_t(i)] = belly * tones.belly + (1 - belly) * tones.tendon;
      mesh.parts[std::size_t(i)] = number;
    }
  }
  DrawItem item;
  item.mesh = int(list.meshes.size());
  item.surface = {
      .color = kMuscleLook.color, .roughness = kMuscleLook.roughness, .specular = 0.045f};
  item.surface.opacity = appearance.looks.front().muscles;
  item.surface.scatter = 0.35f;
  item.surface.striation = 1;
  item.closed = true;
  list.meshes.push_back(std::move(mesh));
  list.items.push_back(item);
}

std::vector<DesignSession::SeenMuscle> DesignSession::picked(const PosedAnatomy& posed) const {
  std::vector<SeenMuscle> out;
  const std::string& name = seen().picked;
  if (name.empty()) return out;
  for (const char* side : {"_l", "_r"}) {
    const auto live = std::ranges::find(live_.muscles, name + side, &Muscle::name);
    if (live != live_.muscles.end()) {
      SeenMuscle one{&*live, {}};
      for (const SliceRange& range : live_model_.strips)
        if (range.muscle == int(live - live_.muscles.begin()))
          for (int k = range.begin; k < range.end && k < int(live_posed_.slices.size()); ++k)
            one.slices.push_back(live_posed_.slices[std::size_t(k)]);
      out.push_back(std::move(one));
      continue;
    }
    const int own = find_muscle(anatomy(), name + side);
    if (own < 0) continue;
    SeenMuscle one{&anatomy().muscles[std::size_t(own)], {}};
    for (const SliceRange& range : shown_->model->strips)
      if (range.muscle == own)
        for (int k = range.begin; k < range.end && k < int(posed.slices.size()); ++k)
          one.slices.push_back(posed.slices[std::size_t(k)]);
    out.push_back(std::move(one));
  }
  return out;
}

std::vector<int> DesignSession::changed_since_saved() const {
  std::vector<int> out;
  const Document &saved = session_.saved(), &now = seen();
  for (const auto& muscle : now.muscles) {
    const int before = find_entry(saved, muscle->left.name);
    if (before >= 0 && saved.muscles[std::size_t(before)] == muscle) continue;
    for (const char* side : {"_l", "_r"})
      if (const int own = find_muscle(anatomy(), muscle->left.name + side); own >= 0)
        out.push_back(own);
  }
  std::ranges::sort(out);
  return out;
}

}  // namespace ecorche
