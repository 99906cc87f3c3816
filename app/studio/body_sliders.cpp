#include "app/studio/body_sliders.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/base_mesh/chest_wall.h"
#include "anatomy/base_mesh/eyes.h"
#include "anatomy/errors.h"
#include "anatomy/muscles/action_line.h"
#include "app/files/actor.h"
#include "app/files/character_file.h"
#include "app/files/fitted_actor.h"
#include "morph/dilation/dilate_muscles.h"
#include "morph/fascia/lay_fascia.h"
#include "morph/fat/fat_layer.h"
#include "morph/fit/fit_character.h"
#include "morph/shapes/body.h"
#include "morph/shapes/modify_body.h"
#include "morph/shapes/shape_space_cache.h"
#include "morph/shapes/statistic_people.h"
#include "skinning/character/live_character.h"

namespace ecorche {
namespace {

using Asked = std::vector<std::optional<double>>;

constexpr const char* kShown[] = {"stature",
                                  "crotch_height",
                                  "arm_length_outseam",
                                  "biacromial_breadth",
                                  "neck_girth",
                                  "chest_girth",
                                  "waist_girth",
                                  "hip_girth",
                                  "thigh_girth",
                                  "calf_girth",
                                  "upper_arm_girth_relaxed",
                                  "forearm_girth",
                                  "weight"};
// Sliders of the statistics' components, after the measures, fat and hip to waist.
constexpr int kComponents = 5;
// A slider that has not moved for this time counts as released, and the next stage begins.
constexpr std::array<std::chrono::milliseconds, 3> kRest{
    std::chrono::milliseconds(0), std::chrono::milliseconds(60), std::chrono::milliseconds(200)};

using Stage = SlidBody::Stage;

bool is_nothing(const Asked& asked) {
  return std::ranges::none_of(asked, [](const auto& value) { return value.has_value(); });
}

// Bones and muscles of another template cannot be fitted with this one.
void require_template(const Character& character, const Template& body_template) {
  const auto same = [](const auto& ours, const auto& theirs) {
    return std::ranges::equal(ours, theirs,
                              [](const auto& a, const auto& b) { return a.name == b.name; });
  };
  if (same(character.anatomy.bones, body_template.anatomy.bones) &&
      same(character.anatomy.muscles, body_template.anatomy.muscles))
    return;
  throw UnfitError(
      fmt::format("{} bones and {} muscles, not those of the template: sliders fit them anew; say "
                  "--template with the one the character was fitted with",
                  character.anatomy.bones.size(), character.anatomy.muscles.size()));
}

PosedAnatomy at_rest(const Anatomy& anatomy, const SceneModel& model) {
  PosedAnatomy posed;
  forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), posed.X_WJ);
  posed.slices = rest_slices(anatomy);
  posed.lengths = model.rest_lengths;
  return posed;
}

}  // namespace

struct BodySliders::Impl {
  Impl(const Assets& opened, Character character, Template body_template);
  ~Impl();

  FittingOptions fitting() const;
  Points solve(const Asked& asked) const;
  std::vector<double> measure(const Points& skin) const;
  Body body_of(const Points& skin) const;
  std::shared_ptr<SlidBody> show(Character character) const;
  std::shared_ptr<SlidBody> go_along(const Points& skin);
  std::shared_ptr<SlidBody> fit_first(const Points& skin) const;
  std::shared_ptr<SlidBody> fit_whole(const Points& skin) const;
  void work(Stage stage, const std::stop_token& stop);
  std::shared_ptr<SlidBody> make(Stage stage, const Asked& values, const Points& skin);
  void publish(long long of, std::shared_ptr<SlidBody> made);
  void give_up(long long of, const std::string& why);
  bool is_due(Stage stage) const;
  long long& done(Stage stage) { return stages_done[std::size_t(stage)]; }

  Character start;
  Template body_template;
  Assets assets;
  BodyPackage package = read_body_package(assets);
  TapeMeasure tape{package, read_measure_table(package, package.tables / "body")};
  std::vector<VertexPart> parts = vertex_parts(package);
  mutable std::optional<LayerOrder> layers;  // of the template, from the first whole fit on
  mutable std::once_flag layers_made;
  ShapeSpace space;
  BodyStatistics statistics;
  std::vector<int> shown_measures;

  std::unique_ptr<LiveAnatomy> live;  // of the thread that carries

  // The last targets have the highest number. Each stage may lag behind it and behind the stage
  // before.
  mutable std::mutex mutex;
  mutable std::condition_variable_any changed;
  Asked asked;
  long long number = 0, shown_number = 0;
  std::array<long long, 3> stages_done{};
  std::array<double, 3> times{};
  std::chrono::steady_clock::time_point asked_at{};
  Points solved;  // the skin of the number that has been carried
  std::shared_ptr<const SlidBody> body, original;
  std::string problem;
  std::array<std::jthread, 3> workers;  // last: they use all of the above
};

BodySliders::Impl::Impl(const Assets& opened, Character character, Template tmpl)
    : start(std::move(character)), body_template(std::move(tmpl)), assets(opened) {
  if (start.body.skin.V.rows() != package.skin_size)
    throw UnfitError(fmt::format(
        "{} skin vertices: sliders need a skin of the base mesh's {}; leave --skin fine away",
        start.body.skin.V.rows(), package.skin_size));
  require_template(start, body_template);
  space = read_shape_space(package, tape, start.body.sex);
  statistics = read_statistics(package, tape, space);
  for (const char* id : kShown) shown_measures.push_back(tape.table().at(id));
  const std::shared_ptr<SlidBody> own = show(start);
  own->stage = Stage::whole;
  body = original = own;
  for (const Stage stage : {Stage::carried, Stage::first, Stage::whole})
    workers[std::size_t(stage)] =
        std::jthread([this, stage](const std::stop_token& stop) { work(stage, stop); });
}

BodySliders::Impl::~Impl() {
  for (std::jthread& worker : workers) worker.request_stop();
}

Points BodySliders::Impl::solve(const Asked& values) const {
  const Points& own = start.body.skin.V;
  if (is_nothing(values)) return own;
  BodyChange change;
  for (std::size_t i = 0; i < shown_measures.size(); ++i)
    if (i < values.size() && values[i]) change.measures.push_back({shown_measures[i], *values[i]});
  if (values.size() > shown_measures.size()) change.fat = values[shown_measures.size()];
  if (values.size() > shown_measures.size() + 1)
    change.hip_waist = values[shown_measures.size() + 1];
  const std::size_t first = shown_measures.size() + 2;
  for (std::size_t k = 0; k < kComponents && first + k < values.size(); ++k)
    if (values[first + k]) change.also.push_back(score_aim(statistics, int(k), *values[first + k]));
  // Fat and girths change at a given height; with a length, the others follow it.
  const bool no_length = std::ranges::none_of(change.measures, [&](const MeasureTarget& target) {
    const MeasureKind kind = tape.measure(target.measure).kind;
    return kind != MeasureKind::girth && kind != MeasureKind::mass;
  });
  change.keep_lengths = no_length && change.also.empty();
  return change_body(package, tape, space, own, change).points;
}

std::vector<double> BodySliders::Impl::measure(const Points& skin) const {
  std::vector<double> out;
  for (int k : shown_measures) out.push_back(tape.take(k, skin));
  out.push_back(fat_percentage(tape, space.sex, skin));
  out.push_back(hip_waist_ratio(tape, skin));
  const Eigen::VectorXd scores = scores_of(statistics, skin);
  out.insert(out.end(), scores.begin(), scores.begin() + kComponents);
  return out;
}

Body BodySliders::Impl::body_of(const Points& skin) const {
  Body out = start.body;
  out.skin.V = skin;
  out.mass = kBodyDensity * skin_volume(package, skin);
  return out;
}

std::shared_ptr<SlidBody> BodySliders::Impl::show(Character character) const {
  auto out = std::make_shared<SlidBody>();
  SceneOptions options;
  options.eyes = find_eyes(package, character.body.skin, character.anatomy.skeleton);
  options.key = fresh_scene_key();
  out->model = make_scene_model(character.anatomy, character.body.skin, options);
  out->rest = at_rest(character.anatomy, out->model);
  out->achieved = measure(character.body.skin.V);
  out->character = std::move(character);
  return out;
}

std::shared_ptr<SlidBody> BodySliders::Impl::go_along(const Points& skin) {
  if (!live) live = std::make_unique<LiveAnatomy>(start);
  live->follow(skin);
  return show(live->character());
}

// fit_character without its slowest step, the separation of neighbouring muscles.
std::shared_ptr<SlidBody> BodySliders::Impl::fit_first(const Points& skin) const {
  const Body fitted_body = body_of(skin);
  Fit fit = fit_anatomy(body_template, fitted_body);
  const std::vector<Muscle> carried = fit.anatomy.muscles;
  const SkinRays rays(chest_wall_skin(package, fitted_body.sex, skin));
  const FatLayer fat = make_fat_layer(body_template.tables.fat, rays, fit.anatomy, fitted_body);
  DilateOptions options;
  options.share = false;
  options.even_about = fit.report.even_about;
  dilate_muscles(fit.anatomy, carried, body_template.tables.muscles, rays, fat, options);
  fit.anatomy.fascia = lay_fascia(fit.fascia, fit.anatomy, rays);
  const std::shared_ptr<SlidBody> out = show({std::move(fit.anatomy), fitted_body});
  out->stage = Stage::first;
  return out;
}

FittingOptions BodySliders::Impl::fitting() const {
  std::call_once(layers_made, [&] { layers = template_layers(body_template, package); });
  return {.parts = &parts, .layers = &*layers};
}

std::shared_ptr<SlidBody> BodySliders::Impl::fit_whole(const Points& skin) const {
  const Body fitted_body = body_of(skin);
  FittingOptions options = fitting();
  options.tissues = false;
  FittedCharacter fitted = fit_character(body_template, fitted_body, package, options);
  std::vector<std::string> missed;
  for (const MissedTarget& target : missed_targets(fitted.report)) missed.push_back(target.what);
  std::shared_ptr<SlidBody> out = show({std::move(fitted.anatomy), fitted_body});
  out->stage = Stage::whole;
  out->missed = std::move(missed);
  return out;
}

// Precondition: the lock is held.
bool BodySliders::Impl::is_due(Stage stage) const {
  const std::size_t k = std::size_t(stage);
  return stages_done[k] != number && (k == 0 || stages_done[k - 1] == number);
}

// Superseded results are not shown, except skins while a slider moves.
void BodySliders::Impl::publish(long long of, std::shared_ptr<SlidBody> made) {
  const std::lock_guard lock(mutex);
  if (of != number && (made->stage != Stage::carried || of < shown_number)) return;
  done(made->stage) = of;
  shown_number = of;
  if (made->stage == Stage::carried) solved = made->character.body.skin.V;
  body = std::move(made);
  changed.notify_all();
}

void BodySliders::Impl::give_up(long long of, const std::string& why) {
  const std::lock_guard lock(mutex);
  stages_done.fill(of);
  if (of == number) problem = why;
  changed.notify_all();
}

std::shared_ptr<SlidBody> BodySliders::Impl::make(Stage stage, const Asked& values,
                                                  const Points& skin) {
  const auto begin = std::chrono::steady_clock::now();
  const std::shared_ptr<SlidBody> made = stage == Stage::carried ? go_along(solve(values))
                                         : stage == Stage::first ? fit_first(skin)
                                                                 : fit_whole(skin);
  const std::lock_guard lock(mutex);
  times[std::size_t(stage)] =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return made;
}

void BodySliders::Impl::work(Stage stage, const std::stop_token& stop) {
  while (true) {
    Asked values;
    Points skin;
    long long of = 0;
    {
      std::unique_lock lock(mutex);
      if (!changed.wait(lock, stop, [&] { return is_due(stage); })) return;
      of = number;
      const auto rested = asked_at + kRest[std::size_t(stage)];
      if (changed.wait_until(lock, stop, rested, [&] { return number != of; }) ||
          stop.stop_requested())
        continue;
      if (!is_due(stage)) continue;
      values = asked;
      skin = solved;
      if (is_nothing(values)) {
        stages_done.fill(of);
        shown_number = of;
        body = original;
        changed.notify_all();
        continue;
      }
    }
    try {
      publish(of, make(stage, values, skin));
    } catch (const std::exception& error) {
      give_up(of, error.what());
    }
  }
}

BodySliders::BodySliders(const Assets& assets, Character start, Template body_template)
    : impl_(std::make_unique<Impl>(assets, std::move(start), std::move(body_template))) {}

BodySliders::~BodySliders() = default;

std::vector<Slider> BodySliders::sliders() const {
  const Impl& s = *impl_;
  std::vector<Slider> out;
  constexpr double kReach = 3.5;  // standard deviations to both sides
  for (int k : s.shown_measures) {
    const Measure& m = s.tape.measure(k);
    const double mean = s.space.law_mean[k], sd = std::sqrt(s.space.law_covariance(k, k));
    const bool mass = m.kind == MeasureKind::mass;
    out.push_back({m.name, mass ? "kg" : "cm", mass ? 1.0 : 100.0,
                   std::max(0.3 * mean, mean - kReach * sd), mean + kReach * sd});
  }
  out.push_back({"fat", "%", 1, 4, 50});
  out.push_back({"hip to waist", "", 1, 0.8, 1.6});
  for (int k = 0; k < kComponents; ++k)
    out.push_back({fmt::format("component {}", k + 1), "sd", 1, -kReach, kReach});
  return out;
}

std::vector<std::optional<double>> BodySliders::asked_by(
    const std::vector<std::string>& measures) const {
  const Impl& s = *impl_;
  Asked out(sliders().size());
  for (const std::string& text : measures) {
    const MeasureTarget target = parse_target(text, s.tape);
    const auto at = std::ranges::find(s.shown_measures, target.measure);
    if (at == s.shown_measures.end())
      throw UsageError(fmt::format("--measure {}: no slider shows it", text));
    out[at - s.shown_measures.begin()] = target.value;
  }
  return out;
}

Body BodySliders::solve(const Asked& asked) const {
  return is_nothing(asked) ? impl_->start.body : impl_->body_of(impl_->solve(asked));
}

void BodySliders::ask(const Asked& asked) {
  Impl& s = *impl_;
  const std::lock_guard lock(s.mutex);
  if (asked == s.asked || (s.number == 0 && is_nothing(asked))) return;
  s.asked = asked;
  s.asked_at = std::chrono::steady_clock::now();
  ++s.number;
  s.problem.clear();
  s.changed.notify_all();
}

std::shared_ptr<const SlidBody> BodySliders::shown() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->body;
}

bool BodySliders::busy() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->stages_done.back() != impl_->number;
}

std::array<double, 3> BodySliders::milliseconds() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->times;
}

std::string BodySliders::problem() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->problem;
}

void BodySliders::wait() const {
  std::unique_lock lock(impl_->mutex);
  impl_->changed.wait(lock, [this] { return impl_->stages_done.back() == impl_->number; });
}

std::vector<MissedTarget> BodySliders::write(const Asked& asked, const std::filesystem::path& file,
                                             Report& report) const {
  const Impl& s = *impl_;
  if (is_nothing(asked)) {
    const BoundCharacter bound = bind_character(s.assets, s.start, report);
    write_character_file(s.assets, file, bound.character, bound.binding, Detail::full, s.package);
    return {};
  }
  const FittedForFile fitted = fit_for_file(s.assets, s.body_template, solve(asked), s.package,
                                            {.fitting = s.fitting()}, report);
  write_character_file(s.assets, file, fitted.bound.character, fitted.bound.binding, Detail::full,
                       s.package);
  return missed_targets(fitted.report);
}

}  // namespace ecorche
