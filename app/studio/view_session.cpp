#include "app/studio/view_session.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "anatomy/base_mesh/eyes.h"
#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/geometry/mesh_measures.h"
#include "app/files/actor_look.h"
#include "app/files/fitted_actor.h"
#include "app/files/open_character.h"
#include "app/files/open_motion.h"
#include "app/files/template_file.h"
#include "morph/shapes/body_model.h"
#include "skinning/motion_files/read_motion.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

Vec3f above_ground(const Vec3& root) { return {float(root.x()), 0, float(root.z())}; }

// Box around the skin at rest and the joints in all frames, with a margin of flesh above them,
// relative to the root's horizontal position.
Eigen::AlignedBox3f bounds_of(const Skeleton& skeleton, const Points& skin, const Motion& motion) {
  constexpr float kFlesh = 0.08f;  // m above a joint
  Eigen::AlignedBox3f box;
  const Vec3f root = above_ground(rest_positions(skeleton).front());
  for (Eigen::Index i = 0; i < skin.rows(); ++i)
    box.extend(Vec3f(skin.row(i).transpose().cast<float>() - root));
  std::vector<Transform> X_WJ;
  for (const Pose& pose : motion.frames) {
    forward_kinematics(skeleton, pose, X_WJ);
    const Vec3f place = above_ground(X_WJ.front().translation());
    for (const Transform& joint : X_WJ) {
      const Vec3f p = joint.translation().cast<float>() - place;
      box.extend(Vec3f(p.x(), p.y() + kFlesh, p.z()));
      box.extend(Vec3f(p.x(), p.y(), p.z()));
    }
  }
  return box;
}

std::string file_name(const fs::path& file, const std::string& otherwise) {
  return file.empty() ? otherwise : file.filename().string();
}

std::string joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += (out.empty() ? "missed: " : "\nmissed: ") + line;
  return out;
}

}  // namespace

ViewSession::ViewSession(const ViewSessionOptions& options, const Common& common, Report& report)
    : options_(options), common_(common), report_(report) {
  std::optional<Actor> actor;
  Character character = open_start(options.character, !options.sliders, actor, report);
  if (options.sliders) {
    sliders_ = std::make_shared<BodySliders>(common.assets, std::move(character),
                                             open_template(common.assets, options.body_template));
    slid_file_ = options.character;
    asked_ = sliders_->asked_by(options.measures);
    show_slid();
  } else {
    performance_ = perform(std::make_shared<const Actor>(std::move(*actor)), options.character,
                           options.motion, report);
    show_performance();
  }
  subject_.pose = [this](int frame, PosedAnatomy& posed, SkinFrame& skin) {
    pose(frame, posed, skin);
  };
  subject_.update = [this](ViewDocument& document, bool wait) { update(document, wait); };
  subject_.open = [this](const fs::path& file) {
    begin(fmt::format("opening {} ...", file.filename().string()),
          [this, file, before = performance_] { return open_file(file, before); });
  };
  if (options.sliders)
    subject_.save = [this](const fs::path& file) {
      begin(fmt::format("fitting and writing {} ...", file.filename().string()),
            [this, file, asked = asked_] { return save_file(file, asked); });
    };
}

ViewSession::~ViewSession() = default;

ViewDocument ViewSession::document() const {
  ViewDocument document;
  document.playing = subject_.frames > 1;
  if (sliders_) document.asked = asked_, document.achieved = slid_->achieved;
  return document;
}

// Opens the first character. The template's muscles are dilated, since they do not fill the skin
// before. `moves`: makes an actor, too.
Character ViewSession::open_start(const fs::path& file, bool moves, std::optional<Actor>& actor,
                                  Report& report) const {
  if (!file.empty()) {
    Character character = open_character(file, common_, report);
    if (moves)
      actor = make_actor(common_.assets, character, report, {.definition = options_.definition});
    return character;
  }
  const BodyPackage package = read_body_package(common_.assets);
  const Template body_template = open_template(common_.assets, options_.body_template);
  Body body = body_template.body;
  if (!options_.sex.empty()) {
    BodySpec average;
    average.sex = options_.sex == "female" ? Sex::female : Sex::male;
    body = make_body(package, average);
  }
  if (!moves) return fit_unbound(body_template, body, package, {.tissues = false}, report);
  actor = fit_actor(common_.assets, body_template, body, package, {}, report).actor;
  return actor->character;
}

std::shared_ptr<ViewSession::Performance> ViewSession::perform(std::shared_ptr<const Actor> actor,
                                                               const fs::path& character,
                                                               const fs::path& motion,
                                                               Report& report) const {
  auto out = std::make_shared<Performance>();
  out->actor = std::move(actor);
  out->character = character;
  out->moved_by = motion;
  const Character& shown = out->actor->character;
  if (motion.empty())
    out->motion.frames.push_back(rest_pose(shown.anatomy.skeleton));
  else
    out->motion = open_motion(motion, *out->actor, options_.retarget, common_, report);
  SceneOptions scene;
  scene.eyes = actor_eyes(common_.assets, *out->actor);
  scene.surface.rows_between = 1;
  scene.key = fresh_scene_key();
  out->model = make_scene_model(shown.anatomy, shown.body.skin, scene);
  out->model.skin.colors = vein_colors(*out->actor, Appearance{}.skin_color);
  if (options_.dynamics && !motion.empty()) out->flesh = make_soft_tissue(*out->actor);
  return out;
}

// An opened motion moves the displayed character; an opened character takes the displayed motion.
ViewSession::Done ViewSession::open_file(const fs::path& file,
                                         const std::shared_ptr<const Performance>& before) const {
  Report aside;
  Done done;
  if (names_motion(file)) {
    if (!before)
      throw UsageError(
          "sliders show the body at rest; open a motion in a window without --sliders");
    done.performance = perform(before->actor, before->character, file, aside);
    done.message =
        fmt::format("{}: {} frames, {:g} a second", file.string(),
                    done.performance->motion.frames.size(), done.performance->motion.fps);
    return done;
  }
  std::optional<Actor> actor;
  Character character = open_start(file, !options_.sliders, actor, aside);
  done.message = fmt::format("{}: {} bones, {} muscles", file.string(),
                             character.anatomy.bones.size(), character.anatomy.muscles.size());
  if (options_.sliders) {
    done.sliders =
        std::make_shared<BodySliders>(common_.assets, std::move(character),
                                      open_template(common_.assets, options_.body_template));
    done.character = file;
  } else {
    done.performance =
        perform(std::make_shared<const Actor>(std::move(*actor)), file, before->moved_by, aside);
  }
  return done;
}

ViewSession::Done ViewSession::save_file(const fs::path& file,
                                         const std::vector<std::optional<double>>& asked) const {
  if (file.extension() != ".glb")
    throw UsageError(fmt::format("{}: a character is written as .glb", file.string()));
  check_output(file, {slid_file_});
  Report aside;
  Done done;
  std::vector<std::string> missed;
  for (const MissedTarget& target : sliders_->write(asked, file, aside))
    missed.push_back(target.what);
  done.message =
      fmt::format("written: {}{}{}", file.string(), missed.empty() ? "" : "\n", joined(missed));
  done.exit_code = missed.empty() ? 0 : 8;
  return done;
}

// One job at a time: a second one is refused, not queued.
void ViewSession::begin(const std::string& state, std::function<Done()> job) {
  if (job_.valid()) return;
  job_state_ = state;
  job_ = std::async(std::launch::async, [job = std::move(job)]() -> Done {
    try {
      return job();
    } catch (const std::exception& error) {
      Done failed;
      failed.message = error.what();
      return failed;
    }
  });
}

void ViewSession::update(ViewDocument& document, bool wait) {
  if (wait && job_.valid()) job_.wait();
  take_job(document);
  if (sliders_) take_sliders(document, wait);
  const bool fitting = sliders_ && sliders_->busy();
  document.busy = job_.valid() || fitting;
  document.state = job_.valid() ? job_state_ : std::string();
  if (!sliders_) return;
  std::string fit = sliders_->problem();
  if (!fit.empty())
    fit = "no anatomy fits: " + fit;
  else if (fitting && slid_->stage == SlidBody::Stage::first)
    fit = "fitted; muscles that overlap are parting ...";
  else if (fitting)
    fit = "bones and muscles go along with the skin; they are being fitted ...";
  else
    fit = joined(slid_->missed);
  document.state += (document.state.empty() || fit.empty() ? "" : "\n") + fit;
}

void ViewSession::take_job(ViewDocument& document) {
  if (!job_.valid() || job_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  const Done done = job_.get();
  document.message = done.message;
  if (done.exit_code != 0) exit_code_ = done.exit_code;
  if (done.performance) {
    performance_ = done.performance;
    document.playing = performance_->motion.frames.size() > 1;
    document.time = 0;
    show_performance();
  }
  if (done.sliders) {
    sliders_ = done.sliders;
    slid_file_ = done.character;
    document.asked = sliders_->asked_by({});
    show_slid();
  }
  if (!done.performance && !done.sliders) return;
  document.selected = 0;
  document.hidden.clear();
}

void ViewSession::take_sliders(ViewDocument& document, bool wait) {
  document.asked.resize(subject_.sliders.size());
  asked_ = document.asked;
  sliders_->ask(asked_);
  if (wait) sliders_->wait();
  if (sliders_->shown() != slid_) show_slid();
  document.achieved = slid_->achieved;
}

void ViewSession::show_performance() {
  const Performance& p = *performance_;
  const Character& character = p.actor->character;
  subject_.anatomy = &character.anatomy;
  subject_.model = &p.model;
  subject_.frames = p.motion.frames.size();
  subject_.fps = p.motion.fps;
  subject_.bounds = bounds_of(character.anatomy.skeleton, character.body.skin.V, p.motion);
  subject_.name = file_name(p.character, "template") +
                  (p.moved_by.empty() ? "" : ", " + p.moved_by.filename().string());
  ++subject_.revision;
  soft_tissue_ = {};
  played_.emplace(*p.actor);
}

void ViewSession::show_slid() {
  slid_ = sliders_->shown();
  constexpr const char* kTimes[] = {"reshape", "first_fit", "whole_fit"};
  const std::array<double, 3> times = sliders_->milliseconds();
  for (std::size_t k = 0; k < times.size(); ++k)
    if (times[k] > 0) report_.set(fmt::format("timings_ms.{}", kTimes[k]), times[k]);
  subject_.anatomy = &slid_->character.anatomy;
  subject_.model = &slid_->model;
  subject_.bounds = bounds_of(slid_->character.anatomy.skeleton, slid_->character.body.skin.V, {});
  subject_.sliders = sliders_->sliders();
  subject_.name =
      file_name(slid_file_, options_.sex.empty() ? "template" : options_.sex) + ", sliders";
  ++subject_.revision;
}

void ViewSession::pose(int frame, PosedAnatomy& posed, SkinFrame& skin) {
  if (sliders_) {
    posed = slid_->rest;
    to_frame(slid_->character.body.skin.V, vertex_normals(slid_->character.body.skin), skin);
    return;
  }
  const Performance& p = *performance_;
  std::swap(played_->posed, posed);
  std::swap(played_->skin, skin);
  if (!p.flesh.vertices.empty())
    seek_soft_tissue(p.flesh, p.actor->character.anatomy.skeleton, p.motion, {},
                     frame / p.motion.fps, soft_tissue_);
  evaluate(*p.actor, p.motion.frames[frame], {{}, soft_tissue_.offsets}, *played_);
  std::swap(played_->posed, posed);
  std::swap(played_->skin, skin);
}

int ViewSession::write(const ViewDocument& document, const fs::path& file) {
  const std::vector<MissedTarget> missed = sliders_->write(document.asked, file, report_);
  for (const MissedTarget& target : missed) {
    note(common_, "missed: " + target.what);
    report_.append_text("missed", target.what);
  }
  return missed.empty() ? 0 : 8;
}

}  // namespace ecorche
