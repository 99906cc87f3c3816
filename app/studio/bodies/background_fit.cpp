#include "app/studio/bodies/background_fit.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <ctime>
#include <deque>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "anatomy/base_mesh/eyes.h"
#include "anatomy/errors.h"
#include "app/edit/document/workshop.h"
#include "app/edit/refit.h"
#include "app/edit/session.h"
#include "app/files/open_motion.h"
#include "morph/fit/refit_character.h"
#include "viewer/coarse_scene.h"
#include "viewer/scene_meshes.h"

namespace ecorche {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostKept = 4;                    // bodies of documents before, for undo
constexpr auto kRest = std::chrono::milliseconds(150);  // without another edit, before it begins
constexpr double kCoarse = 0.022;                       // m, sides of triangles while a hand moves
constexpr double kGuess = 6;                            // s, before one has been fitted

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::shared_ptr<const SceneModel> scene_of(const Character& character, std::vector<Eyeball> eyes,
                                           const ShownBody* before = nullptr) {
  SceneOptions options;
  if (before) options.before = {&before->character().anatomy, &before->model->fascia_surface};
  options.eyes = std::move(eyes);
  options.key = fresh_scene_key();
  SceneModel model = make_scene_model(character.anatomy, character.body.skin, options);
  model.coarse = make_coarse(character.anatomy, model, kCoarse);
  if (before) keep_alike(*before->model, model);
  return std::make_shared<const SceneModel>(std::move(model));
}

std::shared_ptr<const Motion> standing(const Skeleton& skeleton) {
  Motion motion;
  motion.frames.push_back(rest_pose(skeleton));
  return std::make_shared<const Motion>(std::move(motion));
}

bool is_made_for(const ShownBody& body, const Document& document) {
  return body.actor && fits_alike(body.of, document) && body.motion_file == document.trial->motion;
}

}  // namespace

std::shared_ptr<const ShownBody> unfitted_body(const Assets& assets, const Template& base,
                                               const Document& document) {
  auto out = std::make_shared<ShownBody>();
  out->of = document;
  out->unbound = std::make_shared<const Character>(Character{base.anatomy, base.body});
  out->model = scene_of(*out->unbound, find_eyes(assets, base.body.skin, base.anatomy.skeleton));
  out->motion = standing(base.anatomy.skeleton);
  return out;
}

// The last body that was fitted whole: edits of muscles begin from there.
struct WholeFit {
  Document of;
  Body body;
  FitRecord record;
  std::vector<Eyeball> eyes{};
};

// A line that runs beside, on the document as it was then, and what that was compared with.
struct BesideLine {
  Document document;
  std::optional<Document> other;
  std::string text;
};

struct BackgroundFit::Impl {
  Impl(const Common& common_, const Document& built_in, std::shared_ptr<const ShownBody> first,
       Session::Drawer drawer)
      : common(common_),
        workshop(common_.assets, built_in),
        draw(std::move(drawer)),
        shown(std::move(first)) {
    worker = std::jthread([this](const std::stop_token& stop) { work(stop); });
  }

  void work(const std::stop_token& stop);
  void make(const Document& document, long long of);
  std::optional<Character> fit(const Document& document, long long of,
                               std::vector<LandmarkDepth>& landmarks);
  void run_line(const BesideLine& line);
  void say(const char* text) {
    const std::lock_guard lock(mutex);
    stage = text;
  }
  bool superseded(long long of) const {
    const std::lock_guard lock(mutex);
    return of != number;
  }

  Common common;
  Workshop workshop;              // of the worker
  std::optional<WholeFit> whole;  // likewise
  Session::Drawer draw;

  mutable std::mutex mutex;
  std::condition_variable_any changed;
  std::optional<Document> wanted;
  long long number = 0, done = 0;
  Clock::time_point asked_at{}, began{};
  double usual = kGuess;
  bool making = false, running_line = false, cancelled = false;
  std::string stage, problem;
  Said message;
  std::deque<BesideLine> lines;
  std::vector<std::shared_ptr<const ShownBody>> kept;
  std::shared_ptr<const ShownBody> shown;
  std::jthread worker;  // last: it uses all of the above
};

// The document's body with its muscles; none where another one is wanted meanwhile.
std::optional<Character> BackgroundFit::Impl::fit(const Document& document, long long of,
                                                  std::vector<LandmarkDepth>& landmarks) {
  say("placing bones and muscles");
  const Template edited = edited_template(workshop, document);
  FittingOptions fitting = fitting_of(document);
  fitting.judged = fitting.tissues = false;
  if (whole && differs_in_muscles_alone(whole->of, document)) {
    say("growing what lies near");
    if (std::optional<FittedCharacter> made =
            refit_character(edited, whole->body, workshop.package(), fitting, whole->record)) {
      if (superseded(of)) return std::nullopt;
      landmarks = made->report.fit.landmarks;
      return Character{std::move(made->anatomy), whole->body};
    }
  }
  Report aside;
  whole.reset();
  WholeFit next{document, edited_body(workshop, document, common, aside), {}};
  if (superseded(of)) return std::nullopt;
  say("growing the muscles to the skin");
  FittedCharacter made =
      fit_character(edited, next.body, workshop.package(), fitting, &next.record);
  next.eyes = find_eyes(common.assets, next.body.skin, made.anatomy.skeleton);
  whole = std::move(next);
  if (superseded(of)) return std::nullopt;
  landmarks = made.report.fit.landmarks;
  return Character{std::move(made.anatomy), whole->body};
}

// A body for the document; stops between its stages where another one is wanted.
void BackgroundFit::Impl::make(const Document& document, long long of) {
  const std::shared_ptr<const ShownBody> before = [this] {
    const std::lock_guard lock(mutex);
    return shown;
  }();
  auto out = std::make_shared<ShownBody>();
  Report aside;
  out->of = document;
  const auto start = Clock::now();
  const std::clock_t cpu_start = std::clock();
  if (before->actor && fits_alike(before->of, document)) {
    out->actor = before->actor;
    out->model = before->model;
    out->fit_seconds = before->fit_seconds;
    out->fit_cpu_seconds = before->fit_cpu_seconds;
    out->landmarks = before->landmarks;
  } else {
    std::optional<Character> made = fit(document, of, out->landmarks);
    if (!made) return;
    say("binding the skin");
    const bool same_body = before->actor && differs_in_muscles_alone(before->of, document);
    const Character& shown_soon = *made;
    tbb::parallel_invoke(
        [&] {
          out->actor = std::make_shared<const Actor>(
              make_actor(common.assets, shown_soon, aside,
                         {.before = same_body ? before->actor.get() : nullptr}));
        },
        [&] { out->model = scene_of(shown_soon, whole->eyes, before.get()); });
    if (superseded(of)) return;
    out->fit_seconds = seconds_since(start);
    out->fit_cpu_seconds = double(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  }
  out->motion_file = document.trial->motion;
  if (out->motion_file.empty()) {
    out->motion = standing(out->character().anatomy.skeleton);
  } else {
    say("reading the motion");
    out->motion = std::make_shared<const Motion>(
        open_motion(out->motion_file, *out->actor, MotionOptions{}, common, aside));
  }
  const std::lock_guard lock(mutex);
  if (of != number) return;
  usual = std::max(seconds_since(start), 0.5);
  done = of;
  shown = out;
  kept.insert(kept.begin(), out);
  if (kept.size() > kMostKept) kept.pop_back();
}

void BackgroundFit::Impl::run_line(const BesideLine& line) {
  Said said;
  try {
    Report aside;
    Session session(
        common, aside,
        {.document = line.document, .built_in = workshop.built_in(), .other = line.other}, draw);
    session.run_line(line.text);
    said.text = std::visit(
        [&](const auto& action) {
          if constexpr (requires { action.file; })
            return "written: " + std::filesystem::absolute(action.file).string();
          else if constexpr (requires { action.picture.file; })
            return "written: " + std::filesystem::absolute(action.picture.file).string();
          else
            return "done: " + line.text;
        },
        *read_action(line.text));
  } catch (const std::exception& error) {
    said = {error.what(), true};
  }
  const std::lock_guard lock(mutex);
  message = said;
}

void BackgroundFit::Impl::work(const std::stop_token& stop) {
  while (true) {
    Document document;
    std::optional<BesideLine> line;
    long long of = 0;
    {
      std::unique_lock lock(mutex);
      making = running_line = false;
      if (!changed.wait(lock, stop, [this] { return done != number || !lines.empty(); })) return;
      if (!lines.empty()) {
        line = std::move(lines.front());
        lines.pop_front();
        running_line = true;
        stage = line->text.substr(0, line->text.find(' '));
      } else {
        of = number;
        if (changed.wait_until(lock, stop, asked_at + kRest, [&] { return number != of; }))
          continue;
        document = *wanted;
        making = true;
      }
      began = Clock::now();
    }
    if (line) {
      run_line(*line);
      continue;
    }
    try {
      make(document, of);
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex);
      if (of != number) continue;
      problem = error.what();
      done = of;
    }
  }
}

BackgroundFit::BackgroundFit(const Common& common, const Document& built_in,
                             std::shared_ptr<const ShownBody> first, Session::Drawer draw)
    : impl_(std::make_unique<Impl>(common, built_in, std::move(first), std::move(draw))) {}

BackgroundFit::~BackgroundFit() = default;

void BackgroundFit::ask(const Document& document, bool again) {
  Impl& s = *impl_;
  const std::lock_guard lock(s.mutex);
  const bool known = s.wanted && fits_alike(*s.wanted, document) &&
                     s.wanted->trial->motion == document.trial->motion;
  if (known && !again) return;
  s.wanted = document;
  s.problem.clear();
  s.cancelled = false;
  ++s.number;
  s.asked_at = Clock::now();
  const auto made =
      std::ranges::find_if(s.kept, [&](const auto& body) { return is_made_for(*body, document); });
  if (made != s.kept.end()) {
    s.shown = *made;
    s.done = s.number;
  }
  s.changed.notify_all();
}

void BackgroundFit::cancel() {
  Impl& s = *impl_;
  const std::lock_guard lock(s.mutex);
  if (s.done == s.number) return;
  ++s.number;
  s.done = s.number;
  s.cancelled = true;
  s.changed.notify_all();
}

void BackgroundFit::run_beside(const Document& document, const std::optional<Document>& other,
                               const std::string& line) {
  Impl& s = *impl_;
  const std::lock_guard lock(s.mutex);
  s.lines.push_back({document, other, line});
  s.changed.notify_all();
}

std::shared_ptr<const ShownBody> BackgroundFit::newest() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->shown;
}

bool BackgroundFit::busy() const {
  const Impl& s = *impl_;
  const std::lock_guard lock(s.mutex);
  return s.done != s.number || s.running_line || !s.lines.empty();
}

bool BackgroundFit::is_cancelled() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->cancelled;
}

std::string BackgroundFit::stage() const {
  const Impl& s = *impl_;
  const std::lock_guard lock(s.mutex);
  return s.making || s.running_line ? s.stage : std::string();
}

double BackgroundFit::share() const {
  const Impl& s = *impl_;
  const std::lock_guard lock(s.mutex);
  return s.making ? std::min(seconds_since(s.began) / s.usual, 0.99) : 0;
}

std::string BackgroundFit::problem() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->problem;
}

BackgroundFit::Said BackgroundFit::take_message() {
  const std::lock_guard lock(impl_->mutex);
  return std::exchange(impl_->message, {});
}

}  // namespace ecorche
